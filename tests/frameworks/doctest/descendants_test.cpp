// Cases that start processes, see tests/frameworks/descendants.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include "../descendants/descendants.hpp"

#define CASE(name)                                                                                 \
    TEST_CASE(#name)                                                                               \
    {                                                                                              \
        CHECK(descendants::holds(descendants::name));                                              \
    }
DESCENDANTS(CASE)
