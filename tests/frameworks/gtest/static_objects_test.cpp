// Its cases run in a process each, which are forked after its static objects were constructed
// (`fork="main"`). It shows what that means for an object that holds something outside of
// the process: here a directory.

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

namespace {

// A directory that the program creates, and removes when it ends.
struct Directory
{
    Directory()
    {
        std::string name = std::filesystem::temp_directory_path() / "static-objects-XXXXXX";
        path = mkdtemp(name.data());
        std::printf("constructed\n");
        // A child process of a constructor is no server.
        shell_code = WEXITSTATUS(std::system("exit 3"));
        if (std::getenv("ARM_WATCHER") != nullptr) {
            std::thread([] { std::this_thread::sleep_for(std::chrono::hours(1)); }).detach();
        }
    }
    ~Directory() { std::filesystem::remove_all(path); }

    std::filesystem::path path;
    int shell_code = -1;
    int process = getpid();
    int changes = 0;
};

Directory directory;

// A fork server's environment when it was executed.
bool is_forked()
{
    std::ifstream file("/proc/self/environ");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    return text.find("RTF_PROGRAM_FORKS=") != std::string::npos;
}

// What a case changes in memory is not visible to the others.
void expect_own_memory()
{
    EXPECT_EQ(directory.process != getpid(), is_forked());
    EXPECT_EQ(++directory.changes, 1);
    EXPECT_EQ(directory.shell_code, 3);
}

} // namespace

TEST(StaticObjects, First)
{
    std::cout << (is_forked() ? "it is forked\n" : "it is executed\n");
    expect_own_memory();
    EXPECT_TRUE(std::filesystem::exists(directory.path));
    // When this process ends, the destructor removes the directory.
}

TEST(StaticObjects, Second)
{
    const bool exists = std::filesystem::exists(directory.path);
    std::cout << (exists ? "the directory is there\n" : "the directory is gone\n");
    expect_own_memory();
}

TEST(StaticObjects, Crashes)
{
    expect_own_memory();
    // Not left behind where each process has a directory.
    std::filesystem::remove_all(directory.path);
    std::raise(SIGSEGV);
}

TEST(StaticObjects, HasItsEnvironment)
{
    expect_own_memory();
    EXPECT_EQ(std::getenv("RTF_PROGRAM_FORKS"), nullptr);
    EXPECT_EQ(std::getenv("LD_PRELOAD"), nullptr);
    EXPECT_EQ(std::getenv("LD_BIND_NOW"), nullptr);
    ASSERT_NE(std::getenv("ARM_MODE"), nullptr);
    EXPECT_STREQ(std::getenv("ARM_MODE"), "careful");
    EXPECT_EQ(getpgrp(), getpid());
}
