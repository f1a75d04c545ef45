// The cases of tests/frameworks/promises.json.
#include <cstdlib>

#include <gtest/gtest.h>

TEST(Promises, First) {}

TEST(Promises, Second)
{
    EXPECT_EQ(std::system(std::getenv("PROMISE")), 0);
}

TEST(Promises, Third) {}
