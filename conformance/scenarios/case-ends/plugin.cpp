// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include <rtf/TestCase.hpp>

class CaseEnds : public rtf::TestCase
{
public:
    void run() override
    {
        RTF_CASE("assertion")
        {
            RTF_REQUIRE(false, "it moves");
            report("never");
        };
        RTF_CASE("error")
        {
            RTF_ERROR("no bench");
        };
        RTF_CASE("exception")
        {
            throw std::runtime_error("surprise");
        };
        RTF_CASE("after"){};
    }
};

RTF_PLUGIN(CaseEnds);
