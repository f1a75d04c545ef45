// The cases of tests/frameworks/promises.json.
#define BOOST_TEST_MODULE promises
#include <boost/test/unit_test.hpp>

#include <cstdlib>

BOOST_AUTO_TEST_CASE(first) {}

BOOST_AUTO_TEST_CASE(second)
{
    BOOST_TEST(std::system(std::getenv("PROMISE")) == 0);
}

BOOST_AUTO_TEST_CASE(third) {}
