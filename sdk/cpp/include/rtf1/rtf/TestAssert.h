// SPDX-License-Identifier: Apache-2.0
// <rtf/TestAssert.h>, as later versions of RTF 1.x have it.
#include "../TestAssert.h"
