// Cases that end the program, or do not end. As in each framework, complete and in its own terms:
// not shared with Catch2, whose macros are the same.

#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <unistd.h>

TEST_CASE("before")
{
    std::cout << "before the crash\n";
}

TEST_CASE("crashes")
{
    SUBCASE("in a subcase")
    {
        std::cerr << "about to crash\n";
        CHECK(1 == 2); // line: before the signal
        std::raise(SIGSEGV);
    }
    SUBCASE("another subcase") {}
}

TEST_CASE("after the crash")
{
    CHECK(true);
}

TEST_CASE("exits with success")
{
    std::exit(0);
}

TEST_CASE("after the exit")
{
    CHECK(true);
}

TEST_CASE("exits at once")
{
    _exit(3);
}

TEST_CASE("hangs")
{
    for (;;) {
        pause();
    }
}

TEST_CASE("after the hang")
{
    CHECK(1 == 2); // line: after the hang
}

TEST_CASE("aborts")
{
    std::abort();
}

TEST_CASE("is killed")
{
    std::raise(SIGKILL);
}

TEST_CASE("the last one")
{
    std::cout << "the last one\n";
}
