// SPDX-License-Identifier: Apache-2.0
// A test that ends in the way that its parameter names.
#include <chrono>
#include <stdexcept>
#include <string>

#include <rtf/TestCase.hpp>

namespace bench {

struct Odd
{
};

class Endings : public rtf::TestCase
{
public:
    Endings()
    {
        if (param() == "constructor") {
            throw std::runtime_error("no memory for a robot");
        }
    }

    ~Endings() override { RTF_REPORT("destroyed"); }

    bool setup(int, char **) override
    {
        if (param() == "setup-check") {
            RTF_CHECK(false, "the cable is in");
        }
        return true;
    }

    void run() override
    {
        const std::string how = param();
        if (how == "standard") {
            throw std::invalid_argument("joint 9");
        } else if (how == "odd") {
            throw Odd();
        } else if (how == "swallowed") {
            try {
                RTF_FAIL("seen by the host");
            } catch (...) {
                report("a plug-in that catches everything goes on");
            }
        } else if (how == "tolerance") {
            RTF_CHECK_NEAR(1, 1, -1, "x");
        } else if (how == "attach") {
            attach("/nowhere/trace.csv");
        } else if (how == "until") {
            wait_until([] { return 0.0; }, std::chrono::milliseconds(20), "the motor to turn");
        } else if (how == "sleep") {
            report("sleeping");
            sleep(std::chrono::hours(1));
            report("never");
        } else if (how == "loop") {
            report("looping");
            while (!interrupted()) {
            }
            RTF_FAIL("left early");
        }
    }

    void tearDown() override
    {
        if (param() == "tear-down") {
            throw 1.5;
        }
        report("torn down");
    }
};

} // namespace bench

RTF_PLUGIN(bench::Endings);
