// Tests of a simulated arm, with each kind of result that Boost.Test has.

#define BOOST_TEST_MODULE arm
#include <boost/mpl/list.hpp>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <cstdio>
#include <iostream>
#include <stdexcept>
#include <string>

namespace utf = boost::unit_test;

namespace {

int reached(int target)
{
    return target - 1;
}

struct Station
{
    Station() { BOOST_TEST_MESSAGE("the station is on"); }
    ~Station() { BOOST_TEST_MESSAGE("the station is off"); }

    int joints = 6;
};

struct Broken
{
    Broken() { throw std::runtime_error("the station has no power"); }
};

boost::test_tools::assertion_result hasGripper(utf::test_unit_id)
{
    boost::test_tools::assertion_result result(false);
    result.message() << "no gripper, <none>";
    return result;
}

} // namespace

BOOST_AUTO_TEST_CASE(passes) // line: passes
{
    BOOST_TEST(reached(2) == 1);
}

BOOST_AUTO_TEST_CASE(fails)
{
    BOOST_TEST_CONTEXT("moving to \"home\" <left> & back")
    {
        const int position = reached(42);
        BOOST_TEST_INFO("position is " << position);
        BOOST_TEST(position == 42); // line: fails
    }
    BOOST_CHECK(reached(1) == 1);
    BOOST_CHECK_EQUAL(reached(7), 7);
    BOOST_CHECK_CLOSE(0.5, 0.75, 0.1);
    BOOST_CHECK_MESSAGE(reached(5) > 6, "the arm ]]> is\ntoo low");
}

BOOST_AUTO_TEST_CASE(fails_fatally)
{
    BOOST_REQUIRE_EQUAL(reached(3), 3); // line: fails fatally
    BOOST_TEST(false);
}

BOOST_AUTO_TEST_CASE(reports_failure)
{
    BOOST_ERROR("the arm\nis slow"); // line: reports a failure
    BOOST_FAIL("the arm has stopped");
}

BOOST_AUTO_TEST_CASE(throws)
{
    BOOST_TEST_CHECKPOINT("before the exception"); // line: checkpoint
    throw std::runtime_error("no power on \"joint\" <3>");
}

BOOST_AUTO_TEST_CASE(throws_nothing_known)
{
    throw 42;
}

BOOST_AUTO_TEST_CASE(expects_an_exception)
{
    BOOST_CHECK_THROW(reached(1), std::runtime_error); // line: throws nothing
    BOOST_CHECK_NO_THROW(throw std::logic_error("not allowed"));
}

BOOST_AUTO_TEST_CASE(warns)
{
    BOOST_WARN_MESSAGE(reached(1) == 1, "the battery is low");
    BOOST_TEST_MESSAGE("a message");
    BOOST_TEST(true);
}

BOOST_AUTO_TEST_CASE(disabled_one, *utf::disabled() * utf::description("not yet"))
{
    BOOST_TEST(false);
}

BOOST_AUTO_TEST_CASE(needs_a_gripper, *utf::precondition(hasGripper))
{
    BOOST_TEST(false);
}

BOOST_AUTO_TEST_CASE(has_labels, *utf::label("slow") * utf::label("arm"))
{
    BOOST_TEST(true);
}

BOOST_AUTO_TEST_CASE(fails_as_expected, *utf::expected_failures(1))
{
    BOOST_TEST(reached(1) == 1);
}

BOOST_AUTO_TEST_CASE(fails_less_than_expected, *utf::expected_failures(2))
{
    BOOST_TEST(reached(1) == 1);
}

BOOST_AUTO_TEST_CASE(depends_on_fails, *utf::depends_on("fails"))
{
    BOOST_TEST(true);
}

BOOST_AUTO_TEST_CASE(depends_on_passes, *utf::depends_on("passes"))
{
    BOOST_TEST(true);
}

BOOST_AUTO_TEST_CASE(checks_nothing) {}

BOOST_AUTO_TEST_CASE(prints)
{
    std::cout << "<TestCase name=\"forged\">\n";
    std::cout << "on stdout, no newline";
    std::cerr << "on stderr\n";
}

BOOST_AUTO_TEST_CASE(has_arguments)
{
    const auto &suite = utf::framework::master_test_suite();
    BOOST_REQUIRE(suite.argc == 3);
    BOOST_TEST(std::string(suite.argv[2]) == "two words");
}

BOOST_FIXTURE_TEST_CASE(has_a_fixture, Station)
{
    BOOST_TEST(joints == 7); // line: fixture
}

BOOST_FIXTURE_TEST_CASE(has_a_broken_fixture, Broken)
{
    BOOST_TEST(true);
}

BOOST_AUTO_TEST_SUITE(gripper, *utf::label("hand"))

BOOST_AUTO_TEST_CASE(opens) // line: opens
{
    BOOST_TEST(true);
}

BOOST_AUTO_TEST_SUITE(left)
BOOST_AUTO_TEST_CASE(closes)
{
    BOOST_TEST(reached(4) == 4); // line: closes
}
BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(later, *utf::disabled())
BOOST_AUTO_TEST_CASE(moves)
{
    BOOST_TEST(false);
}
BOOST_AUTO_TEST_SUITE_END()

using Numbers = boost::mpl::list<char, double>;

BOOST_AUTO_TEST_CASE_TEMPLATE(is_small, T, Numbers)
{
    BOOST_TEST(sizeof(T) <= 4U); // line: is small
}

BOOST_DATA_TEST_CASE(reaches, utf::data::make({1, 2, 3}), speed)
{
    BOOST_TEST(speed != 2); // line: reaches
}

BOOST_AUTO_TEST_CASE(control_characters)
{
    BOOST_TEST(std::string("bell \a escape \x1b end") == ""); // line: control characters
}

BOOST_AUTO_TEST_CASE(is_not_utf8)
{
    BOOST_TEST(std::string("latin \xe9 \xc3\xbc") == "");
}

BOOST_AUTO_TEST_CASE(the_last_one)
{
    BOOST_TEST(reached(1) == 0);
}
