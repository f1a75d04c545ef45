// SPDX-License-Identifier: Apache-2.0
// <rtf/lua/LuaPluginLoader.h>, as later versions of RTF 1.x have it.
#include "../../lua/LuaPluginLoader.h"
