// Cases that end the program, or do not end.

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <unistd.h>

TEST(Broken, Before)
{
    std::cout << "before the crash\n";
}

TEST(Broken, Crashes) // line: Crashes
{
    std::cerr << "about to crash\n";
    EXPECT_EQ(1, 2) << "before the signal"; // line: before the signal
    std::raise(SIGSEGV);
}

TEST(Broken, AfterCrash) {}

TEST(Broken, ExitsWithSuccess)
{
    std::exit(0);
}

TEST(Broken, AfterExit) {}

TEST(Broken, ExitsAtOnce)
{
    _exit(3);
}

TEST(Broken, Hangs)
{
    for (;;) {
        pause();
    }
}

TEST(Broken, AfterHang)
{
    EXPECT_EQ(1, 2); // line: after the hang
}

TEST(Broken, Aborts)
{
    std::abort();
}

TEST(Broken, Last)
{
    std::cout << "the last one\n";
}

int main(int argc, char **argv)
{
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
