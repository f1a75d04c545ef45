// The cases of tests/frameworks/promises.json.
#include <cstdlib>

#include <gtest/gtest.h>

#include <rtf/session.hpp>

TEST(Promises, First) {}

TEST(Promises, Second)
{
    EXPECT_EQ(std::system(std::getenv("PROMISE")), 0);
}

TEST(Promises, Third)
{
    if (const char *high = std::getenv("MEASURES")) {
        rtf::measure("force", 2.5, "N", 0, std::atof(high));
    }
}
