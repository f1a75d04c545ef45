// SPDX-License-Identifier: Apache-2.0
// Loads a test from a plug-in's file, in any language.
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

    // The test, which the loader owns; null if there is none.
    virtual TestCase *open(const std::string filename) = 0;

    // Destroys the test.
    virtual void close() = 0;

    // The reason why the last open() failed.
    virtual std::string getLastError() = 0;
};

} // namespace plugin
} // namespace robottestingframework

#endif
