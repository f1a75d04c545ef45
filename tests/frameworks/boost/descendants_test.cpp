// Cases that start processes, see tests/frameworks/descendants.
#define BOOST_TEST_MODULE descendants
#include <boost/test/unit_test.hpp>

#include "../descendants/descendants.hpp"

#define CASE(name)                                                                                 \
    BOOST_AUTO_TEST_CASE(name)                                                                     \
    {                                                                                              \
        BOOST_CHECK(descendants::holds(descendants::name));                                        \
    }
DESCENDANTS(CASE)
