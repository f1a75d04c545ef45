// SPDX-License-Identifier: Apache-2.0
// A plug-in for the predecessor: does nothing, or reports N times (its argument).
#include <string>

#include <robottestingframework/TestAssert.h>
#include <robottestingframework/TestCase.h>
#include <robottestingframework/dll/Plugin.h>

class Predecessor : public robottestingframework::TestCase
{
public:
    Predecessor() : TestCase("Predecessor") {}

    bool setup(int argc, char **argv) override
    {
        count_ = argc > 1 ? std::stol(argv[1]) : 0;
        return true;
    }

    void tearDown() override {}

    void run() override
    {
        for (long index = 0; index < count_; ++index) {
            ROBOTTESTINGFRAMEWORK_TEST_REPORT("joint 3 moved to its next position");
        }
        ROBOTTESTINGFRAMEWORK_TEST_CHECK(true, "nothing is wrong");
    }

private:
    long count_ = 0;
};

ROBOTTESTINGFRAMEWORK_PREPARE_PLUGIN(Predecessor)
