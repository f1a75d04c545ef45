// SPDX-License-Identifier: Apache-2.0
// A fixture that a host process runs, and the suite that is its dispatcher.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_HOSTEDFIXTURE_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_HOSTEDFIXTURE_H

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include <rtf/plugin.h>

#include "../FixtureManager.h"
#include "../TestResult.h"
#include "../TestSuite.h"
#include "Attempt.h"
#include "Host.h"
#include "PluginTable.h"

namespace robottestingframework {
namespace internal {

// Sends reports and collapses to the host. It has no tests: the host runs them.
class HostedSuite : public TestSuite, private TestListener
{
public:
    explicit HostedSuite(const rtf_host &host)
        : TestSuite(from_text(host.name(host.context))), host_(host)
    {
        reports_.addListener(this);
        result_ = &reports_;
    }

    void fixtureCollapsed(TestMessage reason) override
    {
        const std::string text = text_of(reason);
        host_.collapsed(host_.context, to_text(text));
    }

    // The tests run in other processes, which the runner stops after a collapse.
    void interrupt() override { fixtureCollapsed("the fixture interrupted the suite"); }

    // Exists while the host waits for a step.
    class Step
    {
    public:
        explicit Step(HostedSuite &suite) : suite_(suite) { suite_.in_step_ = true; }
        ~Step() { suite_.in_step_ = false; }
        Step(const Step &) = delete;
        Step &operator=(const Step &) = delete;

    private:
        HostedSuite &suite_;
    };

private:
    void addReport(const Test *, TestMessage msg) override
    {
        send_to_host(host_, RTF_MESSAGE_REPORT, msg);
    }
    void addError(const Test *, TestMessage msg) override { problem(RTF_MESSAGE_ERROR, msg); }
    void addFailure(const Test *, TestMessage msg) override { problem(RTF_MESSAGE_FAILURE, msg); }

    // During a step, it decides the answer; otherwise it would have no effect.
    void problem(std::int32_t kind, const TestMessage &message)
    {
        send_to_host(host_, kind, message);
        if (!in_step_) {
            fixtureCollapsed(message);
        }
    }

    const rtf_host &host_;
    std::atomic<bool> in_step_{false};
    TestResult reports_;
};

class HostedFixture
{
public:
    template <class T>
    static HostedFixture *create(const rtf_host &host)
    {
        return new HostedFixture(host, std::unique_ptr<FixtureManager>(new T));
    }

    HostedFixture(const rtf_host &host, std::unique_ptr<FixtureManager> fixture)
        : host_(host), suite_(host), fixture_(std::move(fixture))
    {
        fixture_->setParam(from_text(host.param(host.context)));
        fixture_->setDispatcher(&suite_);
    }

    // A fixture's arguments do not include a name; without arguments, it gets an empty
    // one.
    std::int32_t setup(int argc, char **argv)
    {
        nothing_[0] = &empty_;
        nothing_[1] = nullptr;
        return step([&] {
            return argc > 1 ? fixture_->setup(argc - 1, argv + 1) : fixture_->setup(1, nothing_);
        });
    }

    std::int32_t check()
    {
        return step([&] { return fixture_->check(); });
    }

    std::int32_t tear_down()
    {
        return step([&] {
            fixture_->tearDown();
            return true;
        });
    }

private:
    template <class Step>
    std::int32_t step(Step step)
    {
        const HostedSuite::Step in_step(suite_);
        try {
            return step() ? RTF_DONE : RTF_REFUSED;
        } catch (...) {
            send_to_host(host_, RTF_MESSAGE_ERROR, exception_message());
            return RTF_STOPPED;
        }
    }

    const rtf_host &host_;
    char empty_ = '\0';
    char *nothing_[2];
    HostedSuite suite_; // outlives the fixture, whose destructor may report
    std::unique_ptr<FixtureManager> fixture_;
};

// The table of a plug-in whose fixture is a T.
template <class T>
const rtf_plugin_table *fixture_table(const char *name)
{
    using Functions = PluginTable<HostedFixture, T>;
    rtf_plugin_table *const table = Functions::table(RTF_KIND_FIXTURE, name);
    table->check = Functions::check;
    return table;
}

} // namespace internal
} // namespace robottestingframework

#endif
