// The cases of tests/frameworks/promises.json.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <cstdlib>

#include <doctest/doctest.h>

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
