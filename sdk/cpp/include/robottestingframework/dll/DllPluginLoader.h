// SPDX-License-Identifier: Apache-2.0
// Loads a test into this process.
#ifndef ROBOTTESTINGFRAMEWORK_DLLPLUGINLOADER_H
#define ROBOTTESTINGFRAMEWORK_DLLPLUGINLOADER_H

#include <cstddef>
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
        TestCase *const test = plugin_.open(filename, "robottestingframework_dll_factory");
        if (test != nullptr && test->getName().empty()) {
            const std::size_t name = filename.find_last_of('/') + 1; // 0 without a directory
            test->setName(filename.substr(name, filename.find_last_of('.') - name));
        }
        return test;
    }
    void close() override { plugin_.close(); }
    std::string getLastError() override { return plugin_.error(); }

private:
    internal::LoadedPlugin<TestCase> plugin_;
};

} // namespace plugin
} // namespace robottestingframework

#endif
