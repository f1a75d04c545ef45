#define SHLIBPP_FILTER_API
#include <robottestingframework/TestAssert.h>
#include <robottestingframework/TestCase.h>
#include <robottestingframework/dll/Plugin.h>

// A minimal test without a set-up.
class Plain : public robottestingframework::TestCase
{
public:
    Plain() : TestCase("Plain") {}

    void run() override { ROBOTTESTINGFRAMEWORK_TEST_CHECK(true, "this runs"); }
};

ROBOTTESTINGFRAMEWORK_PREPARE_PLUGIN(Plain)
