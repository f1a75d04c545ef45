// SPDX-License-Identifier: Apache-2.0
// The plug-in's table for the host: its functions call a HostedTest or a HostedFixture.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_PLUGINTABLE_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_PLUGINTABLE_H

#include <cstdint>

#include <rtf/plugin.h>

#include "Attempt.h"
#include "Host.h"

namespace robottestingframework {
namespace internal {

// The functions that tests and fixtures share. T is the plug-in's class.
template <class Hosted, class T>
struct PluginTable
{
    static Hosted &get(void *self) { return *static_cast<Hosted *>(self); }

    static void *create(const rtf_host *host)
    {
        try {
            return Hosted::template create<T>(*host);
        } catch (...) {
            send_to_host(*host, RTF_MESSAGE_ERROR, exception_message());
            return nullptr;
        }
    }

    static void destroy(void *self) { delete &get(self); }
    static std::int32_t setup(void *self, int argc, char **argv)
    {
        return get(self).setup(argc, argv);
    }
    static std::int32_t run(void *self) { return get(self).run(); }
    static std::int32_t check(void *self) { return get(self).check(); }
    static std::int32_t tear_down(void *self) { return get(self).tear_down(); }

    static rtf_plugin_table *table(std::int32_t kind, const char *name)
    {
        static rtf_plugin_table table = rtf_plugin_table();
        table.abi_major = RTF_ABI_MAJOR;
        table.abi_minor = RTF_ABI_MINOR;
        table.size = sizeof table;
        table.kind = kind;
        table.name = name;
        table.create = create;
        table.destroy = destroy;
        table.setup = setup;
        table.tear_down = tear_down;
        return &table;
    }
};

} // namespace internal
} // namespace robottestingframework

#endif
