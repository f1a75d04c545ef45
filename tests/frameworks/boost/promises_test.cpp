// The cases of tests/frameworks/promises.json.
#define BOOST_TEST_MODULE promises
#include <boost/test/unit_test.hpp>

#include <cstdlib>

#include <rtf/session.hpp>

BOOST_AUTO_TEST_CASE(first) {}

BOOST_AUTO_TEST_CASE(second)
{
    BOOST_TEST(std::system(std::getenv("PROMISE")) == 0);
}

BOOST_AUTO_TEST_CASE(third)
{
    if (const char *high = std::getenv("MEASURES")) {
        rtf::measure("force", 2.5, "N", 0, std::atof(high));
    }
}
