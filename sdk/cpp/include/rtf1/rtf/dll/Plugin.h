// SPDX-License-Identifier: Apache-2.0
// <rtf/dll/Plugin.h>, as later versions of RTF 1.x have it.
#include "../../dll/Plugin.h"
