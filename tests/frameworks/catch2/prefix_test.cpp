// Names that look like a part of a test specification.
#include <catch2/catch_test_macros.hpp>

TEST_CASE("plain") {}
TEST_CASE("exclude:plain") {}
TEST_CASE("exclude:other") {}
TEST_CASE("other") {}
