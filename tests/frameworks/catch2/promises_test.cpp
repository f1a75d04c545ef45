// The cases of tests/frameworks/promises.json.
#include <cstdlib>

#include <catch2/catch_test_macros.hpp>

TEST_CASE("first") {}

TEST_CASE("second")
{
    CHECK(std::system(std::getenv("PROMISE")) == 0);
}

TEST_CASE("third") {}
