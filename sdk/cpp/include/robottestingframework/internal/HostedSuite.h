// SPDX-License-Identifier: Apache-2.0
// The suite that a hosted fixture has for its dispatcher: reports and collapses
// go to the host. The host runs the tests; this suite has none.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_HOSTEDSUITE_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_HOSTEDSUITE_H

#include <atomic>
#include <string>

#include <rtf/plugin.h>

#include "../TestResult.h"
#include "../TestSuite.h"
#include "Host.h"

namespace robottestingframework {
namespace internal {

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

    // The tests run in other processes: they stop when the fixture is not well.
    void interrupt() override { fixtureCollapsed("the fixture interrupted the suite"); }

    // While it exists, the host waits for the answer of a step.
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
        tell_host(host_, RTF_MESSAGE_REPORT, msg);
    }
    void addError(const Test *, TestMessage msg) override { problem(RTF_MESSAGE_ERROR, msg); }
    void addFailure(const Test *, TestMessage msg) override { problem(RTF_MESSAGE_FAILURE, msg); }

    // In a step it decides the step's answer; otherwise nothing would come of it.
    void problem(std::int32_t kind, const TestMessage &message)
    {
        tell_host(host_, kind, message);
        if (!in_step_) {
            fixtureCollapsed(message);
        }
    }

    const rtf_host &host_;
    std::atomic<bool> in_step_{false};
    TestResult reports_;
};

} // namespace internal
} // namespace robottestingframework

#endif
