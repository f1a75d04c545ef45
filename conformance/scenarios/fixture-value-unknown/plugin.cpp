// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class FixtureValueUnknown : public rtf::TestCase
{
public:
    void run() override
    {
        fixtureValue("simulator.speed");
        report("never");
    }

    void tearDown() override { report("torn down"); }
};

RTF_PLUGIN(FixtureValueUnknown);
