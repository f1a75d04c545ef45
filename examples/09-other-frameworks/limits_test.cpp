// GoogleTest: each joint moves within its limits, and no further.
#include <gtest/gtest.h>
#include <rtf/session.hpp>

#include "arm.hpp"

class Limits : public ::testing::TestWithParam<const char *>
{
protected:
    void TearDown() override { arm_.move(GetParam(), 0.0); }

    Arm arm_;
};

TEST_P(Limits, MovesWithin)
{
    const std::string joint = GetParam();
    EXPECT_TRUE(arm_.reaches(joint, 0.4));
    rtf::measure("error", std::abs(arm_.position(joint) - 0.4), "rad", 0.0, 0.1);
}

TEST_P(Limits, RefusesToMoveBeyond)
{
    EXPECT_THROW(arm_.move(GetParam(), 10.0), std::runtime_error);
}

INSTANTIATE_TEST_SUITE_P(Joints, Limits, ::testing::Values("shoulder", "elbow", "wrist"),
                         [](const auto &info) { return std::string(info.param); });

TEST(Gripper, Opens)
{
    GTEST_SKIP() << "the simulated arm has no gripper";
}
