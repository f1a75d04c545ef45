// SPDX-License-Identifier: Apache-2.0
// A test that a host process runs: the functions of the plug-in's table.
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
#include "Watch.h"

namespace robottestingframework {
namespace internal {

// Whether T has a run(TestResult &) of its own, which then does all steps. One
// that T only brings along (`using TestCase::run`) does them just as well.
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
    struct Own
    {
        bool interrupt;
        bool steps;
    };

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
        name_ = test_->getName();
        first_ = name_;
        first_.push_back('\0');
        arguments_.assign(argv, argv + argc + 1);
        arguments_[0] = &first_[0];
        const bool ready = own_.steps || test_->set_up(argc, arguments_.data());
        tell_name();
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
        tell_name();
        tell_silent_failure();
        return RTF_DONE;
    }

    std::int32_t tear_down()
    {
        watch_.stop();
        if (!own_.steps) {
            attempt(test_.get(), result_, Phase::tear_down, [this] { test_->tearDown(); });
        }
        tell_silent_failure();
        return RTF_DONE;
    }

private:
    // The report knows the test by the suite's name for it.
    void tell_name()
    {
        const std::string name = test_->getName();
        if (name != name_) {
            result_.addReport(test_.get(), TestMessage("test name: " + name));
            name_ = name;
        }
    }

    // A test can fail without a word; the host wants one.
    void tell_silent_failure()
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
    // What argv points to.
    std::string first_;
    std::vector<char *> arguments_;
};

// The table of a plug-in whose test is a T.
template <class T>
struct TestTable
{
    static void *create(const rtf_host *host)
    {
        try {
            std::unique_ptr<TestCase> test(new T);
            const HostedTest::Own own{has_own_interrupt<T>::value, has_own_steps<T>::value};
            return new HostedTest(*host, std::move(test), own);
        } catch (...) {
            tell_host(*host, RTF_MESSAGE_ERROR, exception_message());
            return nullptr;
        }
    }

    static void destroy(void *self) { delete static_cast<HostedTest *>(self); }
    static std::int32_t setup(void *self, int argc, char **argv)
    {
        return static_cast<HostedTest *>(self)->setup(argc, argv);
    }
    static std::int32_t run(void *self) { return static_cast<HostedTest *>(self)->run(); }
    static std::int32_t tear_down(void *self)
    {
        return static_cast<HostedTest *>(self)->tear_down();
    }

    static const rtf_plugin_table *table(const char *name)
    {
        static rtf_plugin_table table = rtf_plugin_table();
        table.abi_major = RTF_ABI_MAJOR;
        table.abi_minor = RTF_ABI_MINOR;
        table.size = sizeof table;
        table.kind = RTF_KIND_TEST;
        table.name = name;
        table.create = create;
        table.destroy = destroy;
        table.setup = setup;
        table.run = run;
        table.tear_down = tear_down;
        return &table;
    }
};

} // namespace internal
} // namespace robottestingframework

#endif
