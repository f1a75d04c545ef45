// SPDX-License-Identifier: Apache-2.0
// A fixture that a host process runs: the functions of the plug-in's table.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_HOSTEDFIXTURE_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_HOSTEDFIXTURE_H

#include <cstdint>
#include <memory>
#include <string>

#include <rtf/plugin.h>

#include "../FixtureManager.h"
#include "Attempt.h"
#include "Host.h"
#include "HostedSuite.h"

namespace robottestingframework {
namespace internal {

class HostedFixture
{
public:
    HostedFixture(const rtf_host &host, std::unique_ptr<FixtureManager> fixture)
        : host_(host), suite_(host), fixture_(std::move(fixture))
    {
        fixture_->setParam(from_text(host.param(host.context)));
        fixture_->setDispatcher(&suite_);
    }

    // A fixture's arguments begin with the first one, not with a name; without
    // any, it gets one that is empty.
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
            tell_host(host_, RTF_MESSAGE_ERROR, exception_message());
            return RTF_STOPPED;
        }
    }

    const rtf_host &host_;
    char empty_ = '\0';
    char *nothing_[2];
    HostedSuite suite_; // outlives the fixture, which may report to its end
    std::unique_ptr<FixtureManager> fixture_;
};

// The table of a plug-in whose fixture is a T.
template <class T>
struct FixtureTable
{
    static void *create(const rtf_host *host)
    {
        try {
            std::unique_ptr<FixtureManager> fixture(new T);
            return new HostedFixture(*host, std::move(fixture));
        } catch (...) {
            tell_host(*host, RTF_MESSAGE_ERROR, exception_message());
            return nullptr;
        }
    }

    static void destroy(void *self) { delete static_cast<HostedFixture *>(self); }
    static std::int32_t setup(void *self, int argc, char **argv)
    {
        return static_cast<HostedFixture *>(self)->setup(argc, argv);
    }
    static std::int32_t check(void *self) { return static_cast<HostedFixture *>(self)->check(); }
    static std::int32_t tear_down(void *self)
    {
        return static_cast<HostedFixture *>(self)->tear_down();
    }

    static const rtf_plugin_table *table(const char *name)
    {
        static rtf_plugin_table table = rtf_plugin_table();
        table.abi_major = RTF_ABI_MAJOR;
        table.abi_minor = RTF_ABI_MINOR;
        table.size = sizeof table;
        table.kind = RTF_KIND_FIXTURE;
        table.name = name;
        table.create = create;
        table.destroy = destroy;
        table.setup = setup;
        table.check = check;
        table.tear_down = tear_down;
        return &table;
    }
};

} // namespace internal
} // namespace robottestingframework

#endif
