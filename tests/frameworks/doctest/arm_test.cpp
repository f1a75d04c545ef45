// Tests of a simulated arm, with each kind of result that doctest has.

#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>
#include <cstring>
#include <iostream>
#include <stdexcept>
#include <string>

namespace {

int reached(int target)
{
    return target - 1;
}

std::string robot = "none";

} // namespace

TEST_CASE("passes") // line: passes
{
    CHECK(reached(2) == 1);
}

TEST_CASE("fails")
{
    INFO("moving to \"home\" <left> & back");
    const int position = reached(42);
    CAPTURE(position);
    CHECK(position == 42); // line: fails
    CHECK_FALSE(position == 41);
    CHECK_MESSAGE(position > 50, "the arm\nis too low");
}

TEST_CASE("fails fatally")
{
    FAIL("the arm\nhas stopped"); // line: fails fatally
}

TEST_CASE("fails without stopping")
{
    FAIL_CHECK("first"); // line: fails without stopping
    REQUIRE(reached(3) == 3);
    CHECK(false);
}

TEST_CASE("throws")
{
    CHECK(true);
    throw std::runtime_error("no power on \"joint\" <3>");
}

TEST_CASE("throws in a check")
{
    const auto read = []() -> int { throw std::out_of_range("no encoder"); };
    CHECK(read() == 3); // line: throws in a check
}

TEST_CASE("throws nothing known")
{
    throw std::string();
}

TEST_CASE("expects an exception")
{
    CHECK_THROWS_AS(reached(1), std::runtime_error); // line: throws nothing
    CHECK_NOTHROW(throw std::logic_error("not allowed"));
    CHECK_THROWS_WITH_AS(throw std::logic_error("left"), "right", std::logic_error);
}

TEST_CASE("is near")
{
    CHECK(0.5 == doctest::Approx(0.75)); // line: is near
}

TEST_CASE("skipped" * doctest::skip())
{
    CHECK(false);
}

TEST_CASE("described" * doctest::description("a longer text"))
{
    CHECK(true);
}

TEST_CASE("may fail" * doctest::may_fail())
{
    CHECK(reached(1) == 1); // line: may fail
}

TEST_CASE("should fail" * doctest::should_fail())
{
    CHECK(reached(1) == 1);
}

TEST_CASE("should fail, but passes" * doctest::should_fail())
{
    CHECK(reached(1) == 0);
}

TEST_CASE("fails twice as expected" * doctest::expected_failures(2))
{
    CHECK(reached(1) == 1);
    CHECK(reached(2) == 2);
}

TEST_CASE("fails less often than expected" * doctest::expected_failures(2))
{
    CHECK(reached(1) == 1);
}

TEST_CASE("takes too long" * doctest::timeout(0.000001))
{
    CHECK(true);
}

TEST_CASE("has subcases") // line: has subcases
{
    int position = 0;
    SUBCASE("left, \"outer\"") // line: left
    {
        position = 1;
        SUBCASE("up")
        {
            CHECK(position == 1);
        }
        SUBCASE("down/far")
        {
            CHECK(position == 2); // line: down
        }
    }
    SUBCASE("right")
    {
        std::cout << "in a subcase\n";
        CHECK(position == 0);
    }
}

TEST_CASE("warns")
{
    MESSAGE("the battery is low");
    WARN(reached(1) == 1);
}

TEST_CASE("prints")
{
    std::cout << "<TestCase name=\"forged\">\n";
    std::cout << "on stdout, no newline";
    std::cerr << "on stderr\n";
}

TEST_CASE("has arguments")
{
    CHECK(robot == "two words");
}

TEST_CASE("name, with comma [and brackets] \"quotes\" \\ * ~ <x> & / \xc3\xbc")
{
    CHECK(reached(1) == 0);
}

TEST_CASE("")
{
    CHECK(true);
}

TEST_CASE("the same name")
{
    CHECK(true);
}
TEST_CASE("the same name")
{
    CHECK(reached(1) == 0);
}

TEST_SUITE("gripper, left")
{
    TEST_CASE("opens") // line: opens
    {
        CHECK(true);
    }
    TEST_CASE("closes")
    {
        CHECK(reached(4) == 4);
    }
}

TEST_CASE_TEMPLATE("is small", T, char, double)
{
    CHECK(sizeof(T) <= 4); // line: is small
}

TEST_CASE("control characters")
{
    CHECK(std::string("bell \a escape \x1b end") == ""); // line: control characters
}

TEST_CASE("is not UTF-8")
{
    CHECK(std::string("latin \xe9") == "");
}

TEST_CASE("the last one")
{
    CHECK(reached(1) == 0);
}

int main(int argc, char **argv)
{
    std::cout << "before all cases\n";
    for (int i = 1; i + 1 < argc; ++i) {
        if (std::strcmp(argv[i], "--robot") == 0) {
            robot = argv[i + 1];
        }
    }
    doctest::Context context(argc, argv);
    const int code = context.run();
    std::cout << "after all cases\n";
    return code;
}
