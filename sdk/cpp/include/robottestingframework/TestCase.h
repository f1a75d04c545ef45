// SPDX-License-Identifier: Apache-2.0
// A test: derive from it, override run(), and set up and tear down what it needs.
#ifndef ROBOTTESTINGFRAMEWORK_TESTCASE_H
#define ROBOTTESTINGFRAMEWORK_TESTCASE_H

#include <atomic>
#include <string>

#include "Arguments.h"
#include "Test.h"
#include "TestResult.h"
#include "internal/Attempt.h"

namespace robottestingframework {
namespace internal {
class HostedTest;
}
namespace plugin {
class DllPluginLoader;
}

class TestCase : public Test
{
public:
    // A test without a name gets its plug-in's name.
    TestCase(std::string name = "", std::string param = "") : Test(name), param_(param) {}
    ~TestCase() override {}

    // Called first. argv[0] is the test's name, then come the arguments in its
    // parameter string. False: the test cannot be run, which is an error.
    virtual bool setup(int /*argc*/, char ** /*argv*/) { return true; }

    // Called last, in any case.
    virtual void tearDown() {}

    // The test itself.
    virtual void run() = 0;

    // Asks the running test to stop. An override may end the wait of run().
    void interrupt() override { interrupted_ = true; }

    // Sets up, runs all repetitions, and tears down.
    void run(TestResult &rsl) override
    {
        begin(rsl);
        rsl.startTest(this);
        if (set_up()) {
            repeat([] { return false; });
        }
        internal::attempt(this, rsl, internal::Phase::tear_down, [this] { tearDown(); });
        if (interrupted_) {
            rsl.addError(this, TestMessage("the test was asked to stop"));
        }
        rsl.endTest(this);
    }

    bool succeeded() const override
    {
        const TestResult *const result = result_;
        return successful_ && (result == nullptr || !result->hasProblem(this));
    }

    // Makes the test fail without a message.
    void failed() { successful_ = false; }

    // The test's result; null before it runs.
    TestResult *getResult() { return result_; }

    void setParam(const std::string param) { param_ = param; }
    std::string getParam() { return param_; }

    // The suite's environment string, for example `--robot simulator`.
    void setEnvironment(const std::string environment) { environment_ = environment; }
    std::string getEnvironment() { return environment_; }

    // How often run() is called between one set-up and one tear-down; 0 is once.
    void setRepetition(unsigned int rep) { repetition_ = rep; }
    unsigned int getRepetition() { return repetition_; }

private:
    friend class internal::HostedTest;
    friend class plugin::DllPluginLoader;

    void begin(TestResult &result)
    {
        result_ = &result;
        successful_ = true;
        interrupted_ = false;
    }

    bool set_up()
    {
        const std::string name = getName();
        internal::ArgumentList arguments(&name, param_);
        return set_up(arguments.count(), arguments.values());
    }

    bool set_up(int argc, char **argv)
    {
        return internal::succeeds(this, *result_, internal::Phase::test, "setup()",
                                  [&] { return setup(argc, argv); });
    }

    // Runs all repetitions, until one fails or the test is asked to stop.
    template <class IsStopped>
    void repeat(IsStopped is_stopped)
    {
        unsigned int count = 0;
        const auto once = [this] { run(); };
        do {
            ++count;
        } while (internal::attempt(this, *result_, internal::Phase::test, once) &&
                 count < repetition_ && !interrupted_ && !is_stopped());
    }

    std::string param_;
    std::string environment_;
    std::atomic<TestResult *> result_{nullptr};
    std::atomic<bool> successful_{true};
    std::atomic<bool> interrupted_{false};
    unsigned int repetition_ = 0;
};

} // namespace robottestingframework

#endif
