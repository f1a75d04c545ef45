// SPDX-License-Identifier: Apache-2.0
// <FixtureManager.h> of RTF 1.x.
#ifndef RTF_1_FIXTUREMANAGER_H
#define RTF_1_FIXTUREMANAGER_H

#include "../robottestingframework/FixtureManager.h"

#include "TestMessage.h"
#include "TestResult.h"

namespace RTF {

using ::robottestingframework::FixtureEvents;
using ::robottestingframework::FixtureManager;

} // namespace RTF

// In the first versions this header was all that a plug-in included.
#include "TestAssert.h"
#include "dll/Plugin.h"

#endif
