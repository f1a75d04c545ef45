// SPDX-License-Identifier: Apache-2.0
// <TestMessage.h> of RTF 1.x.
#ifndef RTF_1_TESTMESSAGE_H
#define RTF_1_TESTMESSAGE_H

#include "../robottestingframework/TestMessage.h"

namespace RTF {

using ::robottestingframework::TestMessage;

} // namespace RTF

#endif
