// SPDX-License-Identifier: Apache-2.0
// <TestListener.h> of RTF 1.x.
#ifndef RTF_1_TESTLISTENER_H
#define RTF_1_TESTLISTENER_H

#include "../robottestingframework/TestListener.h"

#include "Test.h"
#include "TestMessage.h"

namespace RTF {

using ::robottestingframework::TestListener;

} // namespace RTF

#endif
