// SPDX-License-Identifier: Apache-2.0
// <Plugin.h>, as early versions of RTF 1.x have it.
#include "dll/Plugin.h"
