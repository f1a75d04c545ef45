// Cases that start processes, see tests/frameworks/descendants.
#include <gtest/gtest.h>

#include "../descendants/descendants.hpp"

#define CASE(name)                                                                                 \
    TEST(Descendants, name)                                                                        \
    {                                                                                              \
        EXPECT_TRUE(descendants::holds(descendants::name));                                        \
    }
DESCENDANTS(CASE)

TEST(Descendants, skips_after_a_descendant_that_fails)
{
    if (descendants::is_descendant()) {
        ASSERT_TRUE(descendants::has_passed());
        return;
    }
    descendants::execute("fail");
    GTEST_SKIP() << "only here";
}

TEST(Descendants, fails_after_a_descendant_that_skips)
{
    if (descendants::is_descendant()) {
        GTEST_SKIP() << "as a descendant";
    }
    // What it prints arrives where this program's output does.
    std::fflush(stdout);
    std::string output;
    descendants::execute("pass", true, false, output);
    std::fputs(output.c_str(), stdout);
    std::fflush(stdout);
    FAIL() << "only here";
}

// Each test runs in both styles.
class Deaths : public testing::TestWithParam<const char *>
{
protected:
    void SetUp() override
    {
        if (descendants::is_descendant()) {
            GTEST_SKIP();
        }
        testing::FLAGS_gtest_death_test_style = GetParam();
    }
};

TEST_P(Deaths, expects_an_exit_code)
{
    EXPECT_EXIT(std::exit(3), testing::ExitedWithCode(3), "");
}

TEST_P(Deaths, expects_a_text)
{
    EXPECT_DEATH(
        {
            std::fputs("out of reach", stderr);
            std::abort();
        },
        "out of reach");
}

// Nothing dies: the test fails.
TEST_P(Deaths, expects_the_death_of_a_program_that_lives)
{
    EXPECT_DEATH((void)0, "");
}

TEST_P(Deaths, expects_another_text)
{
    EXPECT_DEATH(
        {
            std::fputs("out of reach", stderr);
            std::abort();
        },
        "too fast");
}

INSTANTIATE_TEST_SUITE_P(Styles, Deaths, testing::Values("fast", "threadsafe"),
                         [](const auto &info) { return std::string(info.param); });
