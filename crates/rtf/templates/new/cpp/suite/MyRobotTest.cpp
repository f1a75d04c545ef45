// Tests the joint of the robot.
#include <rtf/rtf.hpp>

#include <chrono>
#include <fstream>
#include <string>

using namespace std::chrono_literals;

// rtf calls setup, run and tearDown, in a separate process for each test.
class MyRobotTest : public rtf::TestCase
{
public:
    // Connect here. A problem in setup is an `error`: the bench is wrong, not the robot.
    bool setup(int argc, char **argv) override
    {
        RTF_REQUIRE(argc == 2, "param in the suite is the goal"); // argv[0] is the test's name
        goal_ = std::stod(argv[1]);
        state_ = fixtureValue("simulator.state");
        return true;
    }

    // Test here. The first problem decides the verdict.
    void run() override
    {
        // Ends the test if it takes longer than 10 s.
        RTF_REQUIRE_UNTIL(position() >= goal_, 10s, "the joint at its goal");
        // A failed check does not end the test.
        RTF_CHECK_NEAR(position(), goal_, 0.5, "joint");
        // Stored with the result, and checked against the limits.
        measure("position", position(), "deg", 0.0, 180.0);
    }

    // Leave the robot as it was. rtf always calls it.
    void tearDown() override {}

private:
    // Reads the position from the stand-in for the robot.
    double position() const
    {
        std::ifstream file(state_);
        double degrees = 0.0;
        file >> degrees;
        RTF_REQUIRE(!file.fail(), "the position can be read");
        return degrees;
    }

    double goal_ = 0.0;
    std::string state_;
};

RTF_PLUGIN(MyRobotTest);
