// SPDX-License-Identifier: Apache-2.0
// <rtf/TestCase.h>, as later versions of RTF 1.x have it.
#include "../TestCase.h"
