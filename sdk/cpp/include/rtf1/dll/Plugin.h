// SPDX-License-Identifier: Apache-2.0
// <dll/Plugin.h> of RTF 1.x: what a plug-in's library exports. Once in each
// library, PREPARE_PLUGIN(Class) or PREPARE_FIXTURE_PLUGIN(Class), behind the
// class or before it.
#ifndef RTF_1_DLL_PLUGIN_H
#define RTF_1_DLL_PLUGIN_H

#include "../../robottestingframework/dll/Plugin.h"

#include "../FixtureManager.h"
#include "../TestCase.h"

namespace RTF {
namespace internal {
template <class Class>
struct Prepared;
}
} // namespace RTF

// `class classname` in a template argument finds a class that is there already,
// wherever its name comes from, and declares one that is not. What the macros make
// of it are templates, which compilers complete at the end of the source.
#define RTF_1_INTERNAL_DECLARE(classname)                                                          \
    typedef ::RTF::internal::Prepared<class classname> rtf_1_prepared_class;

#define PREPARE_PLUGIN(classname)                                                                  \
    RTF_1_INTERNAL_DECLARE(classname) ROBOTTESTINGFRAMEWORK_PREPARE_PLUGIN(classname)
#define PREPARE_FIXTURE_PLUGIN(classname)                                                          \
    RTF_1_INTERNAL_DECLARE(classname) ROBOTTESTINGFRAMEWORK_PREPARE_FIXTURE_PLUGIN(classname)

#endif
