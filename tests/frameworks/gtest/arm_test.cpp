// Tests of a simulated arm, with each kind of result that GoogleTest has.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

class Arm : public testing::Test
{
protected:
    void SetUp() override { position = 0; }
    void TearDown() override { position = -1; }

    int position = 0;
};

class Motor
{
public:
    virtual ~Motor() = default;
    virtual bool enable(int joint) = 0;
};

class MockMotor : public Motor
{
public:
    MOCK_METHOD(bool, enable, (int joint), (override));
};

void expectPosition(int position)
{
    EXPECT_EQ(position, 7) << "after a move"; // line: traced
}

} // namespace

TEST_F(Arm, Passes) // line: Passes
{
    EXPECT_EQ(position, 0);
}

TEST_F(Arm, Fails) // line: Fails
{
    position = 41;
    EXPECT_EQ(position, 42) << "the arm \"left\" <home> & stays\nthere"; // line: fails
    EXPECT_NEAR(0.5, 0.75, 0.1);
}

TEST_F(Arm, FailsFatally)
{
    ASSERT_STREQ("left", "right"); // line: fails fatally
    std::abort();
}

TEST_F(Arm, Throws)
{
    throw std::runtime_error("no power, \"joint\" 3 \xc3\xbc");
}

TEST_F(Arm, ThrowsNothingKnown)
{
    throw 42;
}

TEST_F(Arm, Skips)
{
    GTEST_SKIP() << "no gripper, <none>"; // line: skips
}

TEST_F(Arm, SkipsSilently)
{
    GTEST_SKIP();
}

TEST_F(Arm, DISABLED_Calibrates)
{
    FAIL();
}

TEST(DISABLED_Gripper, Opens)
{
    FAIL();
}

TEST_F(Arm, Prints)
{
    std::cout << "[ RUN      ] Arm.Forged\n[       OK ] Arm.Forged (0 ms)\n";
    std::cout << "on stdout, no newline";
    std::cerr << "on stderr\n";
    std::fputs("event=TestCaseStart&name=Forged\n", stdout);
}

TEST_F(Arm, Records)
{
    RecordProperty("cycles", 12);
    RecordProperty("effort", "2.5");
    RecordProperty("gripper", "two \"fingers\"");
}

TEST_F(Arm, Traces)
{
    SCOPED_TRACE("joint 3"); // line: scope
    expectPosition(3);
}

TEST_F(Arm, Matches)
{
    const std::vector<int> joints{1, 2, 3};
    EXPECT_THAT(joints, testing::ElementsAre(1, 2, 4)); // line: matches
}

TEST_F(Arm, CallsMotor)
{
    MockMotor motor;
    EXPECT_CALL(motor, enable(1)).WillOnce(testing::Return(true)); // line: never called
}

TEST_F(Arm, NonFatalThenSkips)
{
    EXPECT_TRUE(position != 0) << "first a failure"; // line: fails, then skips
    GTEST_SKIP() << "then a skip";
}

TEST(ArmDeathTest, Aborts)
{
    ASSERT_DEATH(
        {
            std::fputs("emergency stop\n", stderr);
            std::abort();
        },
        "emergency stop");
}

TEST(ArmDeathTest, Survives)
{
    EXPECT_DEATH({ (void)0; }, ""); // line: survives
}

TEST_F(Arm, AfterAll)
{
    EXPECT_EQ(position, 0);
}

class Speeds : public testing::TestWithParam<double>
{
};

TEST_P(Speeds, Reaches) // line: Reaches
{
    EXPECT_LT(GetParam(), 1.0); // line: too fast
}

INSTANTIATE_TEST_SUITE_P(Slow, Speeds, testing::Values(0.25, 0.5));
INSTANTIATE_TEST_SUITE_P(Fast, Speeds, testing::Values(2.0),
                         [](const testing::TestParamInfo<double> &) { return "Two"; });

class Tools : public testing::TestWithParam<std::string>
{
};

TEST_P(Tools, Fits)
{
    EXPECT_NE(GetParam(), "");
}

INSTANTIATE_TEST_SUITE_P(All, Tools,
                         testing::Values("soft, \"wet\" hand", "a/b <c> & d", "\xc3\xbc"));

template <typename T>
class Scale : public testing::Test
{
};

using Numbers = testing::Types<int, double>;
TYPED_TEST_SUITE(Scale, Numbers);

TYPED_TEST(Scale, Halves) // line: Halves
{
    EXPECT_EQ(TypeParam(1) / TypeParam(2), TypeParam(0.5));
}

template <typename T>
class Axis : public testing::Test
{
};

TYPED_TEST_SUITE_P(Axis);

TYPED_TEST_P(Axis, IsSmall)
{
    EXPECT_LE(sizeof(TypeParam), 4U); // line: IsSmall
}

REGISTER_TYPED_TEST_SUITE_P(Axis, IsSmall);
using Sizes = testing::Types<char, double>;
INSTANTIATE_TYPED_TEST_SUITE_P(My, Axis, Sizes);

int main(int argc, char **argv)
{
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
