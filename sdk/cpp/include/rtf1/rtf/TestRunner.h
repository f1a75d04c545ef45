// SPDX-License-Identifier: Apache-2.0
// <rtf/TestRunner.h>, as later versions of RTF 1.x have it.
#include "../TestRunner.h"
