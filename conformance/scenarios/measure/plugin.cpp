// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class Measure : public rtf::TestCase
{
public:
    void run() override
    {
        measure("position error", 0.02, "rad", std::nullopt, 0.05);
        measure("rate", 87.5, "Hz", 95, 105);
    }
};

RTF_PLUGIN(Measure);
