// Cases that start processes, see tests/frameworks/descendants.
#include <catch2/catch_test_macros.hpp>

#include "../descendants/descendants.hpp"

#define CASE(name)                                                                                 \
    TEST_CASE(#name)                                                                               \
    {                                                                                              \
        CHECK(descendants::holds(descendants::name));                                              \
    }
DESCENDANTS(CASE)
