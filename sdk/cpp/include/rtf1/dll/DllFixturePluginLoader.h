// SPDX-License-Identifier: Apache-2.0
// <dll/DllFixturePluginLoader.h> of RTF 1.x.
#ifndef RTF_1_DLL_DLLFIXTUREPLUGINLOADER_H
#define RTF_1_DLL_DLLFIXTUREPLUGINLOADER_H

#include "../../robottestingframework/dll/DllFixturePluginLoader.h"

#include "../TestCase.h"

namespace RTF {
namespace plugin {

using ::robottestingframework::plugin::DllFixturePluginLoader;

} // namespace plugin
} // namespace RTF

#endif
