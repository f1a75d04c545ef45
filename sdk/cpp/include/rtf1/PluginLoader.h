// SPDX-License-Identifier: Apache-2.0
// <PluginLoader.h> of RTF 1.x.
#ifndef RTF_1_PLUGINLOADER_H
#define RTF_1_PLUGINLOADER_H

#include "../robottestingframework/PluginLoader.h"

#include "TestCase.h"

namespace RTF {
namespace plugin {

using ::robottestingframework::plugin::PluginLoader;

} // namespace plugin
} // namespace RTF

#endif
