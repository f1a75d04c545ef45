// SPDX-License-Identifier: Apache-2.0
// Runs tests in sequence with fixtures, in this process.
#ifndef ROBOTTESTINGFRAMEWORK_TESTSUITE_H
#define ROBOTTESTINGFRAMEWORK_TESTSUITE_H

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

#include "FixtureManager.h"
#include "Test.h"
#include "TestCase.h"
#include "TestMessage.h"
#include "TestResult.h"
#include "internal/Attempt.h"

namespace robottestingframework {
namespace internal {
class HostedSuite;
}

class TestSuite : public Test, public FixtureEvents
{
public:
    TestSuite(std::string name) : Test(name) {}
    ~TestSuite() override {}

    // The caller owns tests and fixtures.
    void addTest(Test *test) { tests_.push_back(test); }
    void removeTest(Test *test)
    {
        tests_.erase(std::remove(tests_.begin(), tests_.end(), test), tests_.end());
    }

    // Removes tests and fixtures.
    void reset()
    {
        tests_.clear();
        fixtures_.clear();
        up_ = 0;
    }

    // A fixture without a dispatcher reports its collapse to this suite.
    void addFixtureManager(FixtureManager *manager)
    {
        if (manager->getDispatcher() == nullptr) {
            manager->setDispatcher(this);
        }
        fixtures_.push_back(manager);
    }

    // The running test is asked to stop and does not pass; the fixtures are then
    // set up again. From any thread.
    void fixtureCollapsed(TestMessage reason) override
    {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            if (!collapsed_) {
                reason_ = reason;
            }
            collapsed_ = true;
        }
        interrupt_current();
    }

    void run(TestResult &rsl) override
    {
        result_ = &rsl;
        successful_ = true;
        interrupted_ = false;
        forget_collapse();
        rsl.startTestSuite(this);
        if (set_up()) {
            run_tests();
        } else {
            not_run(0);
        }
        internal::attempt(this, rsl, internal::Phase::tear_down, [this] { tearDown(); });
        if (interrupted_) {
            rsl.addFailure(this, TestMessage("the suite was interrupted"));
        }
        rsl.endTestSuite(this);
    }

    // The running test is asked to stop, and no other is run.
    void interrupt() override
    {
        interrupted_ = true;
        interrupt_current();
    }

    bool succeeded() const override
    {
        return successful_ && (result_ == nullptr || !result_->hasProblem(this));
    }

    TestResult *getResult() { return result_; }
    std::size_t size() const { return tests_.size(); }

protected:
    // Sets up the fixtures in order. False: one failed, which has been reported.
    virtual bool setup()
    {
        for (FixtureManager *fixture : fixtures_) {
            ++up_; // a failed fixture may need its tear-down most
            if (!internal::succeeds(this, *result_, internal::Phase::tear_down,
                                    "setup() of a fixture", [&] { return fixture->setup(); })) {
                return false;
            }
        }
        return true;
    }

    // Tears down in reverse order, also after an error in a tear-down.
    virtual void tearDown()
    {
        while (up_ > 0) {
            FixtureManager *const fixture = fixtures_[--up_];
            internal::attempt(this, *result_, internal::Phase::tear_down,
                              [&] { fixture->tearDown(); });
        }
    }

private:
    friend class internal::HostedSuite;

    bool set_up()
    {
        bool ready = false;
        internal::attempt(this, *result_, internal::Phase::tear_down, [&] { ready = setup(); });
        return ready;
    }

    void run_tests()
    {
        std::size_t index = 0;
        while (index < tests_.size() && !interrupted_ && fixtures_are_ready()) {
            run_one(tests_[index]);
            ++index;
        }
        report_collapse();
        not_run(index);
    }

    void run_one(Test *test)
    {
        current_ = test;
        result_->before_end_ = [this, test] { mark_collapsed(test); };
        internal::attempt(test, *result_, internal::Phase::test, [&] { test->run(*result_); });
        result_->before_end_ = nullptr;
        current_ = nullptr;
        successful_ = successful_ && test->succeeded() && !result_->hasProblem(test);
    }

    // Reports the tests from this one on that were not run.
    void not_run(std::size_t first)
    {
        if (first >= tests_.size()) {
            return;
        }
        std::string names;
        for (; first < tests_.size(); ++first) {
            names += (names.empty() ? "" : ", ") + tests_[first]->getName();
        }
        result_->addError(this, TestMessage("not run: " + names));
    }

    // Whether the fixtures work, if necessary after another set-up.
    bool fixtures_are_ready()
    {
        if (!report_collapse() && all_well()) {
            return true;
        }
        result_->addReport(this, TestMessage("the fixtures are set up again"));
        internal::attempt(this, *result_, internal::Phase::tear_down, [this] { tearDown(); });
        forget_collapse();
        return set_up() && all_well();
    }

    bool all_well()
    {
        for (FixtureManager *fixture : fixtures_) {
            if (!internal::succeeds(this, *result_, internal::Phase::tear_down,
                                    "check() of a fixture", [&] { return fixture->check(); })) {
                return false;
            }
        }
        return !report_collapse();
    }

    // A collapse during a test is an error of the test.
    void mark_collapsed(Test *test)
    {
        std::unique_lock<std::mutex> lock(mutex_);
        if (collapsed_) {
            const std::string reason = internal::text_of(reason_);
            lock.unlock();
            result_->addError(test, TestMessage("a fixture collapsed", reason));
        }
    }

    // Adds the collapse that was reported, if there was one.
    bool report_collapse()
    {
        std::unique_lock<std::mutex> lock(mutex_);
        if (!collapsed_) {
            return false;
        }
        collapsed_ = false;
        const TestMessage reason = reason_;
        lock.unlock();
        result_->addError(this, reason);
        return true;
    }

    void forget_collapse()
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        collapsed_ = false;
    }

    // Without a lock: a signal handler may call it.
    void interrupt_current()
    {
        Test *const test = current_;
        if (test != nullptr) {
            test->interrupt();
        }
    }

    std::vector<Test *> tests_;
    std::vector<FixtureManager *> fixtures_;
    // The number of fixtures, from the first on, to tear down.
    std::size_t up_ = 0;
    TestResult *result_ = nullptr;
    bool successful_ = true;
    std::atomic<bool> interrupted_{false};
    std::atomic<Test *> current_{nullptr};
    std::mutex mutex_; // of what follows
    bool collapsed_ = false;
    TestMessage reason_;
};

} // namespace robottestingframework

#endif
