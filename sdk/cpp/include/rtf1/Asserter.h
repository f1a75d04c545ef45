// SPDX-License-Identifier: Apache-2.0
// <Asserter.h> of RTF 1.x.
#ifndef RTF_1_ASSERTER_H
#define RTF_1_ASSERTER_H

#include "../robottestingframework/Asserter.h"

#include "Exception.h"
#include "TestSuite.h"

namespace RTF {

using ::robottestingframework::Asserter;

} // namespace RTF

#endif
