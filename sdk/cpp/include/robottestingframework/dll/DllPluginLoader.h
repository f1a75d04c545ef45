// SPDX-License-Identifier: Apache-2.0
// Loads a test into this process.
#ifndef ROBOTTESTINGFRAMEWORK_DLLPLUGINLOADER_H
#define ROBOTTESTINGFRAMEWORK_DLLPLUGINLOADER_H

#include <string>

#include "../PluginLoader.h"
#include "../TestCase.h"
#include "../internal/LoadedPlugin.h"

namespace robottestingframework {
namespace plugin {

class DllPluginLoader : public PluginLoader
{
public:
    DllPluginLoader() {}

    TestCase *open(const std::string filename) override
    {
        return plugin_.open(filename, "robottestingframework_dll_factory");
    }
    void close() override { plugin_.close(); }
    std::string getLastError() override { return plugin_.error(); }

private:
    internal::LoadedPlugin<TestCase> plugin_;
};

} // namespace plugin
} // namespace robottestingframework

#endif
