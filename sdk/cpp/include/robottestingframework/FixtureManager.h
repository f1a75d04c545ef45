// SPDX-License-Identifier: Apache-2.0
// A fixture: derive from it, and override functions as needed.
#ifndef ROBOTTESTINGFRAMEWORK_FIXTUREMANAGER_H
#define ROBOTTESTINGFRAMEWORK_FIXTUREMANAGER_H

#include <string>

#include "Arguments.h"
#include "FixtureEvents.h"
#include "TestMessage.h"
#include "TestResult.h"

namespace robottestingframework {

class FixtureManager
{
public:
    FixtureManager(std::string param = "") : param_(param) {}
    FixtureManager(FixtureEvents *dispatcher, std::string param = "")
        : param_(param), dispatcher_(dispatcher)
    {
    }
    virtual ~FixtureManager() {}

    // Sets up with the arguments in the parameter string.
    bool setup()
    {
        const std::string none;
        internal::ArgumentList arguments(nullptr, param_);
        if (arguments.count() > 0) {
            return setup(arguments.count(), arguments.values());
        }
        internal::ArgumentList empty(&none, param_);
        return setup(empty.count(), empty.values());
    }

    // Called before the tests. argv[0] is the first argument, not a name; without
    // a parameter string it is one empty argument. False: it failed.
    virtual bool setup(int /*argc*/, char ** /*argv*/) { return true; }

    // Called after the tests, also when setup() failed.
    virtual void tearDown() {}

    // Whether the fixture works; called before each test.
    virtual bool check() { return true; }

    void setDispatcher(FixtureEvents *dispatcher) { dispatcher_ = dispatcher; }

    // The recipient of a collapse, from any thread.
    FixtureEvents *getDispatcher() { return dispatcher_; }

    void setParam(const std::string param) { param_ = param; }
    std::string getParam() { return param_; }

private:
    std::string param_;
    FixtureEvents *dispatcher_ = nullptr;
};

} // namespace robottestingframework

#endif
