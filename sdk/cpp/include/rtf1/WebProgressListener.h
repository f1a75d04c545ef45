// SPDX-License-Identifier: Apache-2.0
// <WebProgressListener.h> of RTF 1.x.
#ifndef RTF_1_WEBPROGRESSLISTENER_H
#define RTF_1_WEBPROGRESSLISTENER_H

#include "../robottestingframework/WebProgressListener.h"

#include "TestListener.h"

namespace RTF {

using ::robottestingframework::WebProgressListener;

} // namespace RTF

#endif
