// SPDX-License-Identifier: Apache-2.0
// <dll/Plugin.h> of RTF 1.x: what a plug-in's library exports. Once in each
// library, PREPARE_PLUGIN(Class) or PREPARE_FIXTURE_PLUGIN(Class).
#ifndef RTF_1_DLL_PLUGIN_H
#define RTF_1_DLL_PLUGIN_H

#include "../../robottestingframework/dll/Plugin.h"

#include "../FixtureManager.h"
#include "../TestCase.h"

#define PREPARE_PLUGIN(classname) ROBOTTESTINGFRAMEWORK_PREPARE_PLUGIN(classname)
#define PREPARE_FIXTURE_PLUGIN(classname) ROBOTTESTINGFRAMEWORK_PREPARE_FIXTURE_PLUGIN(classname)

#endif
