// A test for robot-testing-framework 2.x.
#include <robottestingframework/TestAssert.h>
#include <robottestingframework/dll/Plugin.h>

class OldTest : public robottestingframework::TestCase
{
public:
    OldTest() : robottestingframework::TestCase("OldTest") {}

    void run() override { ROBOTTESTINGFRAMEWORK_TEST_CHECK(1 + 1 == 2, "arithmetic"); }
};

ROBOTTESTINGFRAMEWORK_PREPARE_PLUGIN(OldTest)
