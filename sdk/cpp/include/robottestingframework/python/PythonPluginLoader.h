// SPDX-License-Identifier: Apache-2.0
// Loads a test that is written in Python.
#ifndef ROBOTTESTINGFRAMEWORK_PYTHONPLUGINLOADER_H
#define ROBOTTESTINGFRAMEWORK_PYTHONPLUGINLOADER_H

#include "../internal/ScriptTest.h"

namespace robottestingframework {
namespace plugin {

class PythonPluginLoader : public internal::ScriptLoader
{
};

} // namespace plugin
} // namespace robottestingframework

#endif
