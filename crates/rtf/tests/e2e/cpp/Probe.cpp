// SPDX-License-Identifier: Apache-2.0
// A test that lets the fixture collapse, and sleeps until it is asked to stop.
#include <chrono>
#include <fstream>

#include <rtf/TestCase.hpp>

class Probe : public rtf::TestCase
{
public:
    void run() override
    {
        std::ofstream("go") << "yes";
        sleep(std::chrono::seconds(param() == "--wait" ? 60 : 0));
    }

    void tearDown() override { report("the arm is at rest"); }
};

RTF_PLUGIN(Probe)
