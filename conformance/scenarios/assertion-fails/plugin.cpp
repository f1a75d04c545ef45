// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class AssertionFails : public rtf::TestCase
{
public:
    void run() override
    {
        RTF_REQUIRE(false, "the arm is calibrated");
        report("unreachable");
    }

    void tearDown() override { report("torn down"); }
};

RTF_PLUGIN(AssertionFails);
