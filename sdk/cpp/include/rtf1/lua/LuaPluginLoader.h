// SPDX-License-Identifier: Apache-2.0
// <lua/LuaPluginLoader.h> of RTF 1.x.
#ifndef RTF_1_LUA_LUAPLUGINLOADER_H
#define RTF_1_LUA_LUAPLUGINLOADER_H

#include "../../robottestingframework/lua/LuaPluginLoader.h"

#include "../TestCase.h"

namespace RTF {
namespace plugin {

using ::robottestingframework::plugin::LuaPluginLoader;

} // namespace plugin
} // namespace RTF

#endif
