// SPDX-License-Identifier: Apache-2.0
// Exports a plug-in's functions, with or without SHLIBPP_FILTER_API.
#ifndef ROBOTTESTINGFRAMEWORK_DLL_CONFIG_H
#define ROBOTTESTINGFRAMEWORK_DLL_CONFIG_H

#include <rtf/plugin.h>

#define SHLIBPP_EXPORT RTF_EXPORT
#define SHLIBPP_POINTER_SIZE __SIZEOF_POINTER__

#endif
