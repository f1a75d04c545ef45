// SPDX-License-Identifier: Apache-2.0
// <TestResult.h> of RTF 1.x.
#ifndef RTF_1_TESTRESULT_H
#define RTF_1_TESTRESULT_H

#include "../robottestingframework/TestResult.h"

#include "TestListener.h"

namespace RTF {

using ::robottestingframework::TestResult;

} // namespace RTF

#endif
