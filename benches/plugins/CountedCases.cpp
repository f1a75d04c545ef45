// As many cases of GoogleTest as the environment demands, which do nothing.
#include <cstdlib>

#include <gtest/gtest.h>

namespace {

class Many : public testing::TestWithParam<int>
{
};

int count()
{
    const char *const text = std::getenv("BENCH_CASES");
    return text == nullptr ? 1 : std::atoi(text);
}

} // namespace

TEST_P(Many, Passes)
{
    EXPECT_GE(GetParam(), 0);
}

INSTANTIATE_TEST_SUITE_P(All, Many, testing::Range(0, count()));
