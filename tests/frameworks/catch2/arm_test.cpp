// Tests of a simulated arm, with each kind of result that Catch2 has.

#include <catch2/benchmark/catch_benchmark.hpp>
#include <catch2/catch_session.hpp>
#include <catch2/catch_template_test_macros.hpp>
#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include <cstdio>
#include <iostream>
#include <stdexcept>
#include <string>

namespace {

int reached(int target)
{
    return target - 1;
}

class Station
{
protected:
    int joints = 6;
};

} // namespace

TEST_CASE("passes", "[arm][fast]") // line: passes
{
    CHECK(reached(2) == 1);
}

TEST_CASE("fails", "[arm]")
{
    INFO("moving to \"home\" <left> & back");
    const int position = reached(42);
    CAPTURE(position);
    CHECK(position == 42); // line: fails
    CHECK_FALSE(position == 41);
}

TEST_CASE("fails fatally")
{
    FAIL("the arm\nhas stopped"); // line: fails fatally
}

TEST_CASE("throws")
{
    CHECK(true); // line: before the exception
    throw std::runtime_error("no power on \"joint\" <3>");
}

TEST_CASE("throws in a check")
{
    const auto read = []() -> int { throw std::out_of_range("no encoder"); };
    CHECK(read() == 3); // line: throws in a check
}

TEST_CASE("throws nothing known")
{
    throw 42;
}

TEST_CASE("expects an exception")
{
    CHECK_THROWS_AS(reached(1), std::runtime_error); // line: throws nothing
    CHECK_NOTHROW(throw std::logic_error("not allowed"));
}

TEST_CASE("matches")
{
    CHECK_THAT("left arm", Catch::Matchers::ContainsSubstring("right")); // line: matches
    CHECK_THAT(0.5, Catch::Matchers::WithinAbs(0.75, 0.1));
}

TEST_CASE("skips", "[arm]")
{
    SKIP("no gripper, <none>"); // line: skips
}

TEST_CASE("skips silently")
{
    SKIP();
}

TEST_CASE("checks, then skips")
{
    CHECK(reached(1) == 1); // line: fails, then skips
    SKIP("too late");
}

TEST_CASE("has sections", "[arm]") // line: has sections
{
    int position = 0;
    SECTION("left, \"outer\"") // line: left
    {
        position = 1;
        SECTION("up")
        {
            CHECK(position == 1);
        }
        SECTION("down/far")
        {
            CHECK(position == 2); // line: down
        }
    }
    SECTION("right")
    {
        std::cout << "in a section\n";
        CHECK(position == 0);
    }
}

TEST_CASE("skips a section")
{
    SECTION("runs")
    {
        SUCCEED("it ran");
    }
    SECTION("is skipped")
    {
        SKIP("no left hand");
    }
}

TEST_CASE("generates")
{
    const int speed = GENERATE(1, 2, 3);
    SECTION("at a speed")
    {
        CAPTURE(speed);
        CHECK(speed != 2); // line: generates
    }
}

TEST_CASE("warns")
{
    WARN("the battery is low");
    CHECK_NOFAIL(reached(1) == 1);
    UNSCOPED_INFO("only with the next one");
    CHECK(true);
}

TEST_CASE("should fail", "[!shouldfail]")
{
    CHECK(reached(1) == 1); // line: should fail
}

TEST_CASE("should fail, but passes", "[!shouldfail]")
{
    CHECK(reached(1) == 0);
}

TEST_CASE("may fail", "[!mayfail]")
{
    CHECK(reached(1) == 1);
}

TEST_CASE("hidden", "[.][slow]")
{
    CHECK(reached(1) == 1);
}

TEST_CASE("prints")
{
    std::cout << "<TestCase name=\"forged\" tags=\"\">\n";
    std::cout << "on stdout, no newline";
    std::cerr << "on stderr\n";
    std::fputs("on C's stdout\n", stdout);
}

TEST_CASE("name, with comma [and brackets] \"quotes\" 'single' \\ * ~ <x> & / \xc3\xbc",
          "[odd tag]")
{
    CHECK(reached(1) == 0);
}

TEST_CASE("  spaces around  ")
{
    CHECK(reached(1) == 0);
}

TEST_CASE("no check at all") {}

TEST_CASE("measures", "[!benchmark]")
{
    BENCHMARK("reach, <fast>")
    {
        return reached(7);
    };
}

TEST_CASE_METHOD(Station, "has a fixture", "[station]")
{
    CHECK(joints == 7); // line: fixture
}

TEMPLATE_TEST_CASE("is small", "[template]", char, double)
{
    CHECK(sizeof(TestType) <= 4); // line: is small
}

TEST_CASE("control characters")
{
    CHECK(std::string("bell \a escape \x1b end") == ""); // line: control characters
}

TEST_CASE("is not UTF-8")
{
    CHECK(std::string("latin \xe9") == ""); // line: latin
}

TEST_CASE("the last one")
{
    CHECK(reached(1) == 0);
}

int main(int argc, char **argv)
{
    std::cout << "before all cases\n";
    const int code = Catch::Session().run(argc, argv);
    std::cout << "after all cases\n";
    return code;
}
