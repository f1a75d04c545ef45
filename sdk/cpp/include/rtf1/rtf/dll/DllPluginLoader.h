// SPDX-License-Identifier: Apache-2.0
// <rtf/dll/DllPluginLoader.h>, as later versions of RTF 1.x have it.
#include "../../dll/DllPluginLoader.h"
