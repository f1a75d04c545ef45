// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class Cases : public rtf::TestCase
{
public:
    void run() override
    {
        RTF_CASE("joint 0", {{"joint", 0}})
        {
            report("moved");
        };
        RTF_CASE("joint 1")
        {
            RTF_CHECK(false, "joint 1 moves");
            report("still here");
        };
        RTF_CASE("joint 2")
        {
            RTF_CHECK(true, "joint 2 moves");
        };
    }
};

RTF_PLUGIN(Cases);
