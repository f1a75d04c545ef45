// SPDX-License-Identifier: Apache-2.0
// <TextOutputter.h> of RTF 1.x.
#ifndef RTF_1_TEXTOUTPUTTER_H
#define RTF_1_TEXTOUTPUTTER_H

#include "../robottestingframework/TextOutputter.h"

#include "TestResultCollector.h"

namespace RTF {

using ::robottestingframework::TextOutputter;

} // namespace RTF

#endif
