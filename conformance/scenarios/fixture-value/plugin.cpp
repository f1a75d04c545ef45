// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <string>

#include <rtf/TestCase.hpp>

class FixtureValue : public rtf::TestCase
{
public:
    void run() override
    {
        const std::string values =
            fixtureValue("simulator.port") + " " + fixtureValue("simulator.model") + " " +
            fixtureValue("simulator.ready") + " " + fixtureValue("simulator.limits");
        if (values != "40123 arm true [-1.5,1.5]") {
            RTF_FAIL("wrong values: " + values);
        }
        const char *port = std::getenv("RTF_FIXTURE_SIMULATOR_PORT");
        if (port == nullptr || std::string(port) != "40123") {
            RTF_FAIL("wrong port in the environment");
        }
        report("values read");
    }
};

RTF_PLUGIN(FixtureValue);
