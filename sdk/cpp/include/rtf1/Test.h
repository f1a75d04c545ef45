// SPDX-License-Identifier: Apache-2.0
// <Test.h> of RTF 1.x.
#ifndef RTF_1_TEST_H
#define RTF_1_TEST_H

#include "../robottestingframework/Test.h"

namespace RTF {

using ::robottestingframework::Test;

} // namespace RTF

#endif
