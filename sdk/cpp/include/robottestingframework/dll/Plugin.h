// SPDX-License-Identifier: Apache-2.0
// The exports of a plug-in's library. Once in each library, one of:
//   ROBOTTESTINGFRAMEWORK_PREPARE_PLUGIN(Class)          a TestCase
//   ROBOTTESTINGFRAMEWORK_PREPARE_FIXTURE_PLUGIN(Class)  a FixtureManager
// The runner's host calls rtf_plugin() (spec/plugin-abi.md); other programs that load the
// plug-in call the factory.
#ifndef ROBOTTESTINGFRAMEWORK_PLUGIN_H
#define ROBOTTESTINGFRAMEWORK_PLUGIN_H

#include "../internal/HostedFixture.h"
#include "../internal/HostedTest.h"
#include "SharedLibraryClass.h"

#define ROBOTTESTINGFRAMEWORK_PLUGIN_FACTORY_NAME "robottestingframework_dll_factory"
#define ROBOTTESTINGFRAMEWORK_FIXTURE_FACTORY_NAME "robottestingframework_fixture_factory"

#define ROBOTTESTINGFRAMEWORK_PREPARE_PLUGIN(classname)                                            \
    extern "C" RTF_EXPORT const rtf_plugin_table *rtf_plugin(void)                                 \
    {                                                                                              \
        return ::robottestingframework::internal::test_table<classname>(#classname);               \
    }                                                                                              \
    SHLIBPP_DEFINE_SHARED_SUBCLASS(robottestingframework_dll_factory, classname,                   \
                                   ::robottestingframework::TestCase)

#define ROBOTTESTINGFRAMEWORK_PREPARE_FIXTURE_PLUGIN(classname)                                    \
    extern "C" RTF_EXPORT const rtf_plugin_table *rtf_plugin(void)                                 \
    {                                                                                              \
        return ::robottestingframework::internal::fixture_table<classname>(#classname);            \
    }                                                                                              \
    SHLIBPP_DEFINE_SHARED_SUBCLASS(robottestingframework_fixture_factory, classname,               \
                                   ::robottestingframework::FixtureManager)

#endif
