// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class CaseCritical : public rtf::TestCase
{
public:
    void run() override
    {
        RTF_CASE("dangerous")
        {
            RTF_REQUIRE_CRITICAL(false, "the arm is free");
        };
        RTF_CASE("never")
        {
            report("never");
        };
    }
};

RTF_PLUGIN(CaseCritical);
