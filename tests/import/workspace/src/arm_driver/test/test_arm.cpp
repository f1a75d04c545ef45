#include <gtest/gtest.h>

TEST(Arm, Moves)
{
    EXPECT_EQ(1, 1);
}

TEST(Arm, Fails)
{
    EXPECT_EQ(1, 2);
}
