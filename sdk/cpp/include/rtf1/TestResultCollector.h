// SPDX-License-Identifier: Apache-2.0
// <TestResultCollector.h> of RTF 1.x.
#ifndef RTF_1_TESTRESULTCOLLECTOR_H
#define RTF_1_TESTRESULTCOLLECTOR_H

#include "../robottestingframework/TestResultCollector.h"

#include "ResultEvent.h"
#include "TestListener.h"

namespace RTF {

using ::robottestingframework::TestResultCollector;

} // namespace RTF

#endif
