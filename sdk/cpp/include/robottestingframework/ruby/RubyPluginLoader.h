// SPDX-License-Identifier: Apache-2.0
// Loads a test that is written in Ruby.
#ifndef ROBOTTESTINGFRAMEWORK_RUBYPLUGINLOADER_H
#define ROBOTTESTINGFRAMEWORK_RUBYPLUGINLOADER_H

#include "../internal/ScriptTest.h"

namespace robottestingframework {
namespace plugin {

class RubyPluginLoader : public internal::ScriptLoader
{
};

} // namespace plugin
} // namespace robottestingframework

#endif
