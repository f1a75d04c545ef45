// SPDX-License-Identifier: Apache-2.0
// Passes the messages of tests and suites to its listeners. From any thread; calls one
// listener at a time.
#ifndef ROBOTTESTINGFRAMEWORK_TESTRESULT_H
#define ROBOTTESTINGFRAMEWORK_TESTRESULT_H

#include <algorithm>
#include <functional>
#include <mutex>
#include <set>
#include <vector>

#include "Test.h"
#include "TestListener.h"
#include "TestMessage.h"

namespace robottestingframework {

class TestSuite;

class TestResult
{
public:
    TestResult() {}
    virtual ~TestResult() {}
    TestResult(const TestResult &) = delete;
    TestResult &operator=(const TestResult &) = delete;

    // The caller owns the listener. Listeners are called in the order of adding.
    void addListener(TestListener *listener)
    {
        const Lock lock(mutex_);
        if (listener != nullptr &&
            std::find(listeners_.begin(), listeners_.end(), listener) == listeners_.end()) {
            listeners_.push_back(listener);
        }
    }
    void removeListener(TestListener *listener)
    {
        const Lock lock(mutex_);
        listeners_.erase(std::remove(listeners_.begin(), listeners_.end(), listener),
                         listeners_.end());
    }

    // Removes the listeners.
    void reset()
    {
        const Lock lock(mutex_);
        listeners_.clear();
        problems_.clear();
    }

    void addReport(const Test *test, TestMessage msg)
    {
        each([&](TestListener &listener) { listener.addReport(test, msg); });
    }
    // An error or a failure from any caller makes its test or suite fail.
    void addError(const Test *test, TestMessage msg)
    {
        const Lock lock(mutex_);
        problems_.insert(test);
        each([&](TestListener &listener) { listener.addError(test, msg); });
    }
    void addFailure(const Test *test, TestMessage msg)
    {
        const Lock lock(mutex_);
        problems_.insert(test);
        each([&](TestListener &listener) { listener.addFailure(test, msg); });
    }

    void startTest(const Test *test)
    {
        const Lock lock(mutex_);
        problems_.erase(test);
        each([&](TestListener &listener) { listener.startTest(test); });
    }
    void endTest(const Test *test)
    {
        const Lock lock(mutex_);
        if (before_end_) {
            before_end_();
        }
        each([&](TestListener &listener) { listener.endTest(test); });
    }
    void startTestSuite(const Test *test)
    {
        const Lock lock(mutex_);
        problems_.erase(test);
        each([&](TestListener &listener) { listener.startTestSuite(test); });
    }
    void endTestSuite(const Test *test)
    {
        each([&](TestListener &listener) { listener.endTestSuite(test); });
    }
    void startTestRunner()
    {
        each([](TestListener &listener) { listener.startTestRunner(); });
    }
    void endTestRunner()
    {
        each([](TestListener &listener) { listener.endTestRunner(); });
    }

    // Whether the test has an error or a failure since it started.
    bool hasProblem(const Test *test) const
    {
        const Lock lock(mutex_);
        return problems_.count(test) > 0;
    }

private:
    friend class TestSuite;

    // A listener may add a message or a listener.
    using Mutex = std::recursive_mutex;
    using Lock = std::lock_guard<Mutex>;

    template <class Call>
    void each(Call call)
    {
        const Lock lock(mutex_);
        const std::vector<TestListener *> listeners = listeners_;
        for (TestListener *listener : listeners) {
            call(*listener);
        }
    }

    mutable Mutex mutex_;
    std::vector<TestListener *> listeners_;
    std::set<const Test *> problems_;
    // Called by the running suite before a test ends.
    std::function<void()> before_end_;
};

} // namespace robottestingframework

#endif
