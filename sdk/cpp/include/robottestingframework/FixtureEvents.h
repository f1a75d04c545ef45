// SPDX-License-Identifier: Apache-2.0
// The recipient of a fixture's collapse: a suite, or the runner.
#ifndef ROBOTTESTINGFRAMEWORK_FIXTUREEVENTS_H
#define ROBOTTESTINGFRAMEWORK_FIXTUREEVENTS_H

#include "TestMessage.h"

namespace robottestingframework {

class FixtureEvents
{
public:
    virtual ~FixtureEvents() {}

    // May be called from any thread.
    virtual void fixtureCollapsed(TestMessage reason) = 0;
};

} // namespace robottestingframework

#endif
