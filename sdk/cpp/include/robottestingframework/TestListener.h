// SPDX-License-Identifier: Apache-2.0
// A listener for a run's events. Override functions as needed.
#ifndef ROBOTTESTINGFRAMEWORK_TESTLISTENER_H
#define ROBOTTESTINGFRAMEWORK_TESTLISTENER_H

#include "Test.h"
#include "TestMessage.h"

namespace robottestingframework {

class TestListener
{
public:
    TestListener() = default;
    virtual ~TestListener() = default;

    // `test` may be a suite.
    virtual void addReport(const Test * /*test*/, TestMessage /*msg*/) {}
    virtual void addError(const Test * /*test*/, TestMessage /*msg*/) {}
    virtual void addFailure(const Test * /*test*/, TestMessage /*msg*/) {}

    virtual void startTest(const Test * /*test*/) {}
    virtual void endTest(const Test * /*test*/) {}
    virtual void startTestSuite(const Test * /*test*/) {}
    virtual void endTestSuite(const Test * /*test*/) {}
    virtual void startTestRunner() {}
    virtual void endTestRunner() {}
};

} // namespace robottestingframework

#endif
