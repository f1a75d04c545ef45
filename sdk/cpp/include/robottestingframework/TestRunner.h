// SPDX-License-Identifier: Apache-2.0
// Runs tests and suites in sequence, in this process.
#ifndef ROBOTTESTINGFRAMEWORK_TESTRUNNER_H
#define ROBOTTESTINGFRAMEWORK_TESTRUNNER_H

#include <algorithm>
#include <atomic>
#include <vector>

#include "Test.h"
#include "TestResult.h"
#include "internal/Attempt.h"

namespace robottestingframework {

class TestRunner
{
public:
    TestRunner() {}
    virtual ~TestRunner() {}

    // The caller owns the tests.
    void addTest(Test *test) { tests_.push_back(test); }
    void removeTest(Test *test)
    {
        tests_.erase(std::remove(tests_.begin(), tests_.end(), test), tests_.end());
    }
    void reset() { tests_.clear(); }

    void run(TestResult &result)
    {
        interrupted_ = false;
        result.startTestRunner();
        for (Test *test : tests_) {
            if (interrupted_) {
                result.addError(test, TestMessage("not run: the runner was interrupted"));
                continue;
            }
            current_ = test;
            internal::attempt(test, result, internal::Phase::test, [&] { test->run(result); });
            current_ = nullptr;
        }
        result.endTestRunner();
    }

    // Asks the running test to stop, and runs no further tests. From any thread, and
    // from a signal handler if the running test's interrupt() allows it.
    void interrupt()
    {
        interrupted_ = true;
        Test *const test = current_;
        if (test != nullptr) {
            test->interrupt();
        }
    }

private:
    std::vector<Test *> tests_;
    std::atomic<Test *> current_{nullptr};
    std::atomic<bool> interrupted_{false};
};

} // namespace robottestingframework

#endif
