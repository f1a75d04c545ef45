// SPDX-License-Identifier: Apache-2.0
// <rtf/TestMessage.h>, as later versions of RTF 1.x have it.
#include "../TestMessage.h"
