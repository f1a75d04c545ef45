// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class Monitor : public rtf::TestCase
{
public:
    void run() override { monitor("always(level < 2m)"); }
};

RTF_PLUGIN(Monitor);
