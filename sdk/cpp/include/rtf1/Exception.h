// SPDX-License-Identifier: Apache-2.0
// <Exception.h> of RTF 1.x.
#ifndef RTF_1_EXCEPTION_H
#define RTF_1_EXCEPTION_H

#include "../robottestingframework/Exception.h"

#include "TestMessage.h"

namespace RTF {

using ::robottestingframework::Exception;
using ::robottestingframework::FixtureException;
using ::robottestingframework::TestErrorException;
using ::robottestingframework::TestFailureException;

} // namespace RTF

#endif
