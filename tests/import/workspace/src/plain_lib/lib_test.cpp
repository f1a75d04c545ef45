#include <gtest/gtest.h>

TEST(Lib, A) {}

TEST(Lib, B)
{
    EXPECT_EQ(1, 2);
}
