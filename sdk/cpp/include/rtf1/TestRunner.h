// SPDX-License-Identifier: Apache-2.0
// <TestRunner.h> of RTF 1.x.
#ifndef RTF_1_TESTRUNNER_H
#define RTF_1_TESTRUNNER_H

#include "../robottestingframework/TestRunner.h"

#include "TestResult.h"

namespace RTF {

using ::robottestingframework::TestRunner;

} // namespace RTF

#endif
