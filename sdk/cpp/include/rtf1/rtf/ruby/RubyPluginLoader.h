// SPDX-License-Identifier: Apache-2.0
// <rtf/ruby/RubyPluginLoader.h>, as later versions of RTF 1.x have it.
#include "../../ruby/RubyPluginLoader.h"
