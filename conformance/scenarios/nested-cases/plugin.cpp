// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class NestedCases : public rtf::TestCase
{
public:
    void run() override
    {
        RTF_CASE("Arm")
        {
            RTF_CASE("Moves")
            {
                RTF_CHECK(false, "it moves");
            };
            RTF_CASE("Stops"){};
        };
        RTF_CASE("Hand"){};
    }
};

RTF_PLUGIN(NestedCases);
