// A program with arguments of its own, an environment, and results outside of tests.

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <string>

namespace {

std::string robot = "none";

class Bench : public testing::Environment
{
public:
    void SetUp() override { std::cout << "bench for " << robot << "\n"; }
};

class Station : public testing::Test
{
protected:
    static void SetUpTestSuite() { std::cout << "station\n"; }
    static void TearDownTestSuite()
    {
        EXPECT_EQ(robot, "real") << "the station is left dirty"; // line: tear-down of the suite
    }
};

} // namespace

TEST(Arguments, Robot)
{
    EXPECT_EQ(robot, "two words");
}

TEST(Arguments, Environment)
{
    const char *value = std::getenv("ARM_MODE");
    ASSERT_NE(value, nullptr);
    EXPECT_STREQ(value, "careful");
}

TEST_F(Station, Passes) {}

int main(int argc, char **argv)
{
    testing::InitGoogleTest(&argc, argv);
    testing::AddGlobalTestEnvironment(new Bench);
    for (int i = 1; i + 1 < argc; ++i) {
        if (std::string(argv[i]) == "--robot") {
            robot = argv[i + 1];
        }
    }
    return RUN_ALL_TESTS();
}
