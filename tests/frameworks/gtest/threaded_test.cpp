// Links a library that starts a thread, so its processes are executed.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>

int watchers();

TEST(Threaded, First)
{
    std::ifstream file("/proc/self/environ");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const bool is_forked = text.find("RTF_PROGRAM_FORKS=") != std::string::npos;
    std::cout << (is_forked ? "it is forked\n" : "it is executed\n");
    EXPECT_EQ(watchers(), 1);
}

TEST(Threaded, Second)
{
    EXPECT_EQ(watchers(), 1);
}
