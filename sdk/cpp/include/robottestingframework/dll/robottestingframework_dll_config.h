// SPDX-License-Identifier: Apache-2.0
// How a plug-in's functions are exported. SHLIBPP_FILTER_API may be defined or
// not: they always are.
#ifndef ROBOTTESTINGFRAMEWORK_DLL_CONFIG_H
#define ROBOTTESTINGFRAMEWORK_DLL_CONFIG_H

#include <rtf/plugin.h>

#define SHLIBPP_EXPORT RTF_EXPORT
#define SHLIBPP_POINTER_SIZE __SIZEOF_POINTER__

#endif
