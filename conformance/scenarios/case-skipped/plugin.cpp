// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class CaseSkipped : public rtf::TestCase
{
public:
    void run() override
    {
        RTF_CASE("gripper")
        {
            RTF_SKIP("no gripper is mounted");
        };
        RTF_CASE("arm"){};
    }
};

RTF_PLUGIN(CaseSkipped);
