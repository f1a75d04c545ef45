// SPDX-License-Identifier: Apache-2.0
// <ruby/RubyPluginLoader.h> of RTF 1.x.
#ifndef RTF_1_RUBY_RUBYPLUGINLOADER_H
#define RTF_1_RUBY_RUBYPLUGINLOADER_H

#include "../../robottestingframework/ruby/RubyPluginLoader.h"

#include "../TestCase.h"

namespace RTF {
namespace plugin {

using ::robottestingframework::plugin::RubyPluginLoader;

} // namespace plugin
} // namespace RTF

#endif
