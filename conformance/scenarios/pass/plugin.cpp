// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class Pass : public rtf::TestCase
{
public:
    void run() override
    {
        report("hello");
        RTF_CHECK(1 == 1, "one is one");
    }

    void tearDown() override { report("torn down"); }
};

RTF_PLUGIN(Pass);
