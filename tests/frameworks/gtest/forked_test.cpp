// Its cases run in a process each. It shows whether a process was forked, and that a case
// cannot tell.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>

#include <unistd.h>

namespace {

// An object that the program constructs, and a number that a case changes.
struct Counter
{
    int constructed_by = getpid();
    int changes = 0;
};

Counter counter;

// A fork server's environment when it was executed.
bool is_forked()
{
    std::ifstream file("/proc/self/environ");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    return text.find("RTF_PROGRAM_FORKS=") != std::string::npos;
}

void change()
{
    EXPECT_EQ(counter.constructed_by, getpid());
    EXPECT_EQ(++counter.changes, 1);
}

} // namespace

TEST(Forked, First)
{
    std::cout << (is_forked() ? "it is forked\n" : "it is executed\n");
    change();
}

TEST(Forked, Second)
{
    change();
}

TEST(Forked, HasItsEnvironment)
{
    EXPECT_EQ(std::getenv("RTF_PROGRAM_FORKS"), nullptr);
    EXPECT_EQ(std::getenv("LD_PRELOAD"), nullptr);
    EXPECT_EQ(std::getenv("LD_BIND_NOW"), nullptr);
    EXPECT_EQ(std::getenv("ASAN_OPTIONS"), nullptr);
    ASSERT_NE(std::getenv("ARM_MODE"), nullptr);
    EXPECT_STREQ(std::getenv("ARM_MODE"), "careful");
}

TEST(Forked, LeadsItsProcessGroup)
{
    EXPECT_EQ(getpgrp(), getpid());
}

TEST(Forked, HasStandardInput)
{
    char byte = 0;
    EXPECT_EQ(read(0, &byte, 1), 0);
}
