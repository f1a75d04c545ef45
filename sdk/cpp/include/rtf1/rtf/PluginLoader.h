// SPDX-License-Identifier: Apache-2.0
// <rtf/PluginLoader.h>, as later versions of RTF 1.x have it.
#include "../PluginLoader.h"
