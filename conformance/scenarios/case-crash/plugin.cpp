// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include <rtf/TestCase.hpp>

class CaseCrash : public rtf::TestCase
{
public:
    void run() override
    {
        std::vector<std::string> poses;
        for (int number = 1; number <= 40; ++number) {
            poses.push_back("pose " + std::to_string(number));
        }
        plan_cases(poses);
        for (const std::string &pose : poses) {
            RTF_CASE(pose)
            {
                if (pose == "pose 7") {
                    volatile int *volatile nowhere = nullptr;
                    *nowhere = 1;
                }
            };
        }
    }
};

RTF_PLUGIN(CaseCrash);
