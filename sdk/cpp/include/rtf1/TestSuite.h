// SPDX-License-Identifier: Apache-2.0
// <TestSuite.h> of RTF 1.x.
#ifndef RTF_1_TESTSUITE_H
#define RTF_1_TESTSUITE_H

#include "../robottestingframework/TestSuite.h"

#include "FixtureManager.h"
#include "TestCase.h"

namespace RTF {

using ::robottestingframework::TestSuite;

} // namespace RTF

#endif
