// SPDX-License-Identifier: Apache-2.0
// <rtf/Asserter.h>, as later versions of RTF 1.x have it.
#include "../Asserter.h"
