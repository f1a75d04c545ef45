// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

using namespace std::chrono_literals;

class Sample : public rtf::TestCase
{
public:
    void run() override
    {
        sample("elbow", 0.25, "rad", std::nullopt, 1.5, 500ms);
        sample("current", 2, "", std::nullopt, std::nullopt, 500ms);
        sample("elbow", 1.5, "rad", std::nullopt, 1.5, 1s);
        report("what was sampled comes before");
        int taken = 0;
        sample_for("ramp", 50ms, 20, [&] { return ++taken; });
        sample("elbow", 1.75, "rad", -1.5, 1.5, 1250ms);
        sample("elbow", 2, "rad", -1.5, 1.5, 1500ms);
    }
};

RTF_PLUGIN(Sample);
