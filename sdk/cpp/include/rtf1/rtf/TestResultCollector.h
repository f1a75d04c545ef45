// SPDX-License-Identifier: Apache-2.0
// <rtf/TestResultCollector.h>, as later versions of RTF 1.x have it.
#include "../TestResultCollector.h"
