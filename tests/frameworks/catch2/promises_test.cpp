// The cases of tests/frameworks/promises.json.
#include <cstdlib>

#include <catch2/catch_test_macros.hpp>

#include <rtf/session.hpp>

TEST_CASE("first") {}

TEST_CASE("second")
{
    CHECK(std::system(std::getenv("PROMISE")) == 0);
}

TEST_CASE("third")
{
    if (const char *high = std::getenv("MEASURES")) {
        rtf::measure("force", 2.5, "N", 0, std::atof(high));
    }
}
