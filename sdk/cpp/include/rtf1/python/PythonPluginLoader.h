// SPDX-License-Identifier: Apache-2.0
// <python/PythonPluginLoader.h> of RTF 1.x.
#ifndef RTF_1_PYTHON_PYTHONPLUGINLOADER_H
#define RTF_1_PYTHON_PYTHONPLUGINLOADER_H

#include "../../robottestingframework/python/PythonPluginLoader.h"

#include "../TestCase.h"

namespace RTF {
namespace plugin {

using ::robottestingframework::plugin::PythonPluginLoader;

} // namespace plugin
} // namespace RTF

#endif
