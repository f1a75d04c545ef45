// Cases that end the program, or do not end.

#define BOOST_TEST_MODULE broken
#include <boost/test/unit_test.hpp>

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <unistd.h>

BOOST_AUTO_TEST_CASE(before)
{
    std::cout << "before the crash\n";
}

BOOST_AUTO_TEST_CASE(crashes) // line: crashes
{
    std::cerr << "about to crash\n";
    BOOST_TEST(1 == 2); // line: before the signal
    std::raise(SIGSEGV);
}

BOOST_AUTO_TEST_CASE(after_the_crash)
{
    BOOST_TEST(true);
}

BOOST_AUTO_TEST_CASE(exits_with_success)
{
    std::exit(0);
}

BOOST_AUTO_TEST_CASE(exits_at_once)
{
    _exit(3);
}

BOOST_AUTO_TEST_CASE(hangs)
{
    for (;;) {
        pause();
    }
}

BOOST_AUTO_TEST_CASE(after_the_hang)
{
    BOOST_TEST(1 == 2); // line: after the hang
}

BOOST_AUTO_TEST_CASE(aborts)
{
    std::abort();
}

BOOST_AUTO_TEST_CASE(is_killed)
{
    std::raise(SIGKILL);
}

BOOST_AUTO_TEST_CASE(the_last_one)
{
    std::cout << "the last one\n";
}
