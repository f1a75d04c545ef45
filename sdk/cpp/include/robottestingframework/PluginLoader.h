// SPDX-License-Identifier: Apache-2.0
// Gets a test out of a plug-in's file, whatever it is written in.
#ifndef ROBOTTESTINGFRAMEWORK_PLUGINLOADER_H
#define ROBOTTESTINGFRAMEWORK_PLUGINLOADER_H

#include <string>

#include "TestCase.h"

namespace robottestingframework {
namespace plugin {

class PluginLoader
{
public:
    PluginLoader() = default;
    virtual ~PluginLoader() = default;
    PluginLoader(const PluginLoader &) = delete;
    PluginLoader &operator=(const PluginLoader &) = delete;

    // The test, which stays the loader's; null when there is none.
    virtual TestCase *open(const std::string filename) = 0;

    // Ends the test.
    virtual void close() = 0;

    // Why the last open() failed.
    virtual std::string getLastError() = 0;
};

} // namespace plugin
} // namespace robottestingframework

#endif
