// Fixtures around cases fail, as the argument says.

#define BOOST_TEST_MODULE fixtures
#include <boost/test/unit_test.hpp>

#include <stdexcept>
#include <string>

namespace {

bool is(const std::string &mode)
{
    const auto &suite = boost::unit_test::framework::master_test_suite();
    return suite.argc > 1 && suite.argv[1] == mode;
}

struct Bench
{
    Bench()
    {
        BOOST_TEST(!is("check"), "the bench is cold"); // line: check
        if (is("throw")) {
            throw std::runtime_error("the bench has no power");
        }
    }
    ~Bench() { BOOST_TEST(!is("teardown"), "the bench is left dirty"); }
};

struct Gripper
{
    void setup()
    {
        if (is("suite")) {
            throw std::runtime_error("the gripper has no power");
        }
    }
};

} // namespace

BOOST_TEST_GLOBAL_FIXTURE(Bench);

BOOST_AUTO_TEST_CASE(moves)
{
    BOOST_TEST(true);
}

BOOST_AUTO_TEST_SUITE(gripper, *boost::unit_test::fixture<Gripper>())

BOOST_AUTO_TEST_CASE(opens)
{
    BOOST_TEST(true);
}

BOOST_AUTO_TEST_SUITE_END()
