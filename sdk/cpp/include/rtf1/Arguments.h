// SPDX-License-Identifier: Apache-2.0
// <Arguments.h> of RTF 1.x.
#ifndef RTF_1_ARGUMENTS_H
#define RTF_1_ARGUMENTS_H

#include "../robottestingframework/Arguments.h"

namespace RTF {

using ::robottestingframework::Arguments;

} // namespace RTF

#endif
