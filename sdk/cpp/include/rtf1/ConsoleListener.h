// SPDX-License-Identifier: Apache-2.0
// <ConsoleListener.h> of RTF 1.x.
#ifndef RTF_1_CONSOLELISTENER_H
#define RTF_1_CONSOLELISTENER_H

#include "../robottestingframework/ConsoleListener.h"

#include "TestListener.h"

namespace RTF {

using ::robottestingframework::ConsoleListener;

} // namespace RTF

#endif
