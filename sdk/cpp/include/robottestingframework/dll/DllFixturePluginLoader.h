// SPDX-License-Identifier: Apache-2.0
// Loads a fixture into this process.
#ifndef ROBOTTESTINGFRAMEWORK_DLLFIXTUREPLUGINLOADER_H
#define ROBOTTESTINGFRAMEWORK_DLLFIXTUREPLUGINLOADER_H

#include <string>

#include "../FixtureManager.h"
#include "../internal/LoadedPlugin.h"

namespace robottestingframework {
namespace plugin {

class DllFixturePluginLoader
{
public:
    DllFixturePluginLoader() {}
    virtual ~DllFixturePluginLoader() {}

    // The fixture, which the loader owns; null if there is none.
    FixtureManager *open(const std::string filename)
    {
        return plugin_.open(filename, "robottestingframework_fixture_factory");
    }

    // Destroys the fixture.
    void close() { plugin_.close(); }

    // The reason why the last open() failed.
    std::string getLastError() { return plugin_.error(); }

private:
    internal::LoadedPlugin<FixtureManager> plugin_;
};

} // namespace plugin
} // namespace robottestingframework

#endif
