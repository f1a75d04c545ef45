// SPDX-License-Identifier: Apache-2.0
// <TestCase.h> of RTF 1.x.
#ifndef RTF_1_TESTCASE_H
#define RTF_1_TESTCASE_H

#include "../robottestingframework/TestCase.h"

#include "Test.h"
#include "TestResult.h"

namespace RTF {

using ::robottestingframework::TestCase;

} // namespace RTF

// In the first versions this header was all that a plug-in included.
#include "TestAssert.h"
#include "dll/Plugin.h"

#endif
