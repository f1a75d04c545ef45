// SPDX-License-Identifier: Apache-2.0
// <rtf/python/PythonPluginLoader.h>, as later versions of RTF 1.x have it.
#include "../../python/PythonPluginLoader.h"
