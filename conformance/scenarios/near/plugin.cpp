// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include <rtf/TestCase.hpp>

class Near : public rtf::TestCase
{
public:
    void run() override
    {
        RTF_CHECK_NEAR(1.25, 1.0, 0.1, "gain");
        RTF_CHECK_NEAR(std::vector<double>({1, 2, 3.5}), {1, 2, 3}, 0.1, "pose");
        RTF_CHECK_ANGLE_NEAR(3.1, -3.1, 0.1, "heading");
        RTF_CHECK_ANGLE_NEAR(0, 1, 0.1, "yaw");
    }
};

RTF_PLUGIN(Near);
