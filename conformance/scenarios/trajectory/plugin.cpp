// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

using namespace std::chrono_literals;

class Trajectory : public rtf::TestCase
{
public:
    void run() override
    {
        sample("q", 0, "rad", std::nullopt, std::nullopt, 500ms);
        sample("q", 1, "rad", std::nullopt, std::nullopt, 1500ms);
        sample("q", 1, "rad", std::nullopt, std::nullopt, 2500ms);
        check_trajectory("q", "golden/a.csv", 0.05);
        check_trajectory("q", "golden/b.csv", 0.5, rtf::Align::dtw, 250ms);
        report("the test continues");
    }
};

RTF_PLUGIN(Trajectory);
