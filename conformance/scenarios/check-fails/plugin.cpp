// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class CheckFails : public rtf::TestCase
{
public:
    void run() override
    {
        RTF_CHECK(false, "the gripper is closed");
        report("still here");
    }

    void tearDown() override { report("torn down"); }
};

RTF_PLUGIN(CheckFails);
