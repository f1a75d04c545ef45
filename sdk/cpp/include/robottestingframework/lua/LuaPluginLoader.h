// SPDX-License-Identifier: Apache-2.0
// Loads a test that is written in Lua.
#ifndef ROBOTTESTINGFRAMEWORK_LUAPLUGINLOADER_H
#define ROBOTTESTINGFRAMEWORK_LUAPLUGINLOADER_H

#include "../internal/ScriptTest.h"

namespace robottestingframework {
namespace plugin {

class LuaPluginLoader : public internal::ScriptLoader
{
};

} // namespace plugin
} // namespace robottestingframework

#endif
