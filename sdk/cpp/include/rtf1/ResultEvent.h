// SPDX-License-Identifier: Apache-2.0
// <ResultEvent.h> of RTF 1.x.
#ifndef RTF_1_RESULTEVENT_H
#define RTF_1_RESULTEVENT_H

#include "../robottestingframework/ResultEvent.h"

#include "Test.h"
#include "TestMessage.h"

namespace RTF {

using ::robottestingframework::ResultEvent;
using ::robottestingframework::ResultEventEndSuite;
using ::robottestingframework::ResultEventEndTest;
using ::robottestingframework::ResultEventError;
using ::robottestingframework::ResultEventFailure;
using ::robottestingframework::ResultEventReport;
using ::robottestingframework::ResultEventStartSuite;
using ::robottestingframework::ResultEventStartTest;

} // namespace RTF

#endif
