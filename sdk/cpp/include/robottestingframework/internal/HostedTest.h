// SPDX-License-Identifier: Apache-2.0
// A test that a host process runs.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_HOSTEDTEST_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_HOSTEDTEST_H

#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <rtf/plugin.h>

#include "../TestCase.h"
#include "../TestResult.h"
#include "Attempt.h"
#include "Host.h"
#include "PluginTable.h"
#include "Watch.h"

namespace robottestingframework {
namespace internal {

// Whether T has a run(TestResult &), which then carries out all steps. One that T
// inherits (`using TestCase::run`) does so, too.
template <class T, class = void>
struct has_own_steps : std::false_type
{
};
template <class T>
struct has_own_steps<T,
                     decltype(static_cast<void>(static_cast<void (T::*)(TestResult &)>(&T::run)))>
    : std::true_type
{
};

class HostedTest
{
public:
    // Which functions the test's class overrides.
    struct Own
    {
        bool interrupt;
        bool steps;
    };

    template <class T>
    static HostedTest *create(const rtf_host &host)
    {
        std::unique_ptr<TestCase> test(new T);
        return new HostedTest(host, std::move(test),
                              Own{has_own_interrupt<T>::value, has_own_steps<T>::value});
    }

    HostedTest(const rtf_host &host, std::unique_ptr<TestCase> test, Own own)
        : host_(host), listener_(host), test_(std::move(test)), own_(own)
    {
        result_.addListener(&listener_);
        if (test_->getName().empty()) {
            test_->setName(from_text(host.name(host.context)));
        }
        test_->setParam(from_text(host.param(host.context)));
        test_->setEnvironment(from_text(host.environment(host.context)));
        test_->begin(result_);
    }

    std::int32_t setup(int argc, char **argv)
    {
        if (own_.interrupt) {
            watch_.start(host_, *test_);
        }
        const std::string own = test_->getName();
        const std::string name = from_text(host_.name(host_.context));
        name_ = is_derived(name, own) ? own : name;
        report_name();
        first_ = own;
        first_.push_back('\0');
        arguments_.assign(argv, argv + argc + 1);
        arguments_[0] = &first_[0];
        const bool ready = own_.steps || test_->set_up(argc, arguments_.data());
        report_name();
        return ready ? RTF_DONE : RTF_STOPPED;
    }

    std::int32_t run()
    {
        if (own_.steps) {
            Test &test = *test_;
            attempt(&test, result_, Phase::test, [&] { test.run(result_); });
        } else {
            test_->repeat([this] { return host_.interrupted(host_.context) != 0; });
        }
        report_name();
        report_silent_failure();
        return RTF_DONE;
    }

    std::int32_t tear_down()
    {
        watch_.stop();
        if (!own_.steps) {
            attempt(test_.get(), result_, Phase::tear_down, [this] { test_->tearDown(); });
        }
        report_silent_failure();
        return RTF_DONE;
    }

private:
    // Whether a name in a suite says no more than the test's own: `Arm`, `Arm#2`, `Arm[joint=3]`.
    static bool is_derived(const std::string &name, const std::string &own)
    {
        const bool starts_with_own = name.compare(0, own.size(), own) == 0;
        return starts_with_own &&
               (name.size() == own.size() || name[own.size()] == '#' || name[own.size()] == '[');
    }

    // Reports the test's own name: all others use its name in the suite.
    void report_name()
    {
        const std::string name = test_->getName();
        if (name != name_) {
            result_.addReport(test_.get(), TestMessage("test name: " + name));
            name_ = name;
        }
    }

    // A test can fail without a message; the host needs one.
    void report_silent_failure()
    {
        if (!test_->succeeded() && !result_.hasProblem(test_.get())) {
            result_.addFailure(test_.get(), TestMessage("the test called failed()"));
        }
    }

    const rtf_host &host_;
    HostListener listener_;
    TestResult result_;
    Watch watch_;
    std::unique_ptr<TestCase> test_;
    Own own_;
    std::string name_;
    // The storage of argv.
    std::string first_;
    std::vector<char *> arguments_;
};

// The table of a plug-in whose test is a T.
template <class T>
const rtf_plugin_table *test_table(const char *name)
{
    using Functions = PluginTable<HostedTest, T>;
    rtf_plugin_table *const table = Functions::table(RTF_KIND_TEST, name);
    table->run = Functions::run;
    return table;
}

} // namespace internal
} // namespace robottestingframework

#endif
