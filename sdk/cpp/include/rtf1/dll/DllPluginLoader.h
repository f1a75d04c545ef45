// SPDX-License-Identifier: Apache-2.0
// <dll/DllPluginLoader.h> of RTF 1.x.
#ifndef RTF_1_DLL_DLLPLUGINLOADER_H
#define RTF_1_DLL_DLLPLUGINLOADER_H

#include "../../robottestingframework/dll/DllPluginLoader.h"

#include "../TestCase.h"

namespace RTF {
namespace plugin {

using ::robottestingframework::plugin::DllPluginLoader;

} // namespace plugin
} // namespace RTF

#endif
