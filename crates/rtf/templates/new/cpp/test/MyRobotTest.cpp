// Tests a joint of the robot.
#include <rtf/rtf.hpp>

#include <chrono>
#include <string>

using namespace std::chrono_literals;

// rtf calls setup, run and tearDown, in a separate process for each test.
class MyRobotTest : public rtf::TestCase
{
public:
    // Connect here. A problem in setup is an `error`: the bench is wrong, not the robot.
    bool setup(int argc, char **argv) override
    {
        goal_ = argc > 1 ? std::stod(argv[1]) : 90.0; // argv[0] is the test's name
        return true;
    }

    // Test here. The first problem decides the verdict.
    void run() override
    {
        // Ends the test if it takes longer than 5 s.
        RTF_REQUIRE_UNTIL(step() >= goal_, 5s, "the joint at its goal");
        // A failed check does not end the test.
        RTF_CHECK_NEAR(position_, goal_, 0.5, "joint");
        // Stored with the result, and checked against the limits.
        measure("position", position_, "deg", 0.0, 180.0);
    }

    // Leave the robot as it was. rtf always calls it.
    void tearDown() override { position_ = 0.0; }

private:
    // A stand-in for the robot.
    double step() { return position_ += 15.0; }

    double goal_ = 0.0;
    double position_ = 0.0;
};

RTF_PLUGIN(MyRobotTest);
