// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <spawn.h>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <rtf/TestCase.hpp>

/// Forks a child that returns from `run`, as its parent does what the parameter says.
/// With `start HOW`, starts a process and reports how it ended.
/// As a Lua module, offers the same as the functions `split`, `act` and `start`.
namespace {
constexpr int waitMilliseconds = 500;

/// True in the child. In the parent, returns once the child has ended, or has had time
/// for everything that it can do.
bool split()
{
    const pid_t child = fork();
    if (child == 0) {
        return true;
    }
    for (int i = 0; i < waitMilliseconds && waitpid(child, nullptr, WNOHANG) == 0; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
}

[[noreturn]] void hang()
{
    for (;;) {
        pause();
    }
}

void act(const std::string &what)
{
    if (what == "crash") {
        std::abort();
    }
    if (what == "hang") {
        hang();
    }
    if (what == "exit") {
        _exit(0);
    }
}

/// Executes this program again, with its arguments and its environment.
[[noreturn]] void executeItself()
{
    std::ifstream file("/proc/self/cmdline");
    std::vector<std::string> words;
    for (std::string word; std::getline(file, word, '\0');) {
        words.push_back(word);
    }
    std::vector<char *> argv;
    for (std::string &word : words) {
        argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    execv("/proc/self/exe", argv.data());
    _exit(127);
}

pid_t spawnShell()
{
    std::string shell = "sh";
    std::string option = "-c";
    std::string command = "exit 3";
    char *argv[] = {shell.data(), option.data(), command.data(), nullptr};
    pid_t child = -1;
    posix_spawn(&child, "/bin/sh", nullptr, nullptr, argv, environ);
    return child;
}

constexpr int isChild = -1;

/// Starts a process and returns how it ended, as a shell does; `isChild` in a child that is to
/// return from the test.
int start(const std::string &how)
{
    int status = 0;
    if (how == "system") {
        status = std::system("exit 3");
    } else {
        const pid_t child = how == "spawn" ? spawnShell() : fork();
        if (child == 0) {
            if (how == "return") {
                return isChild;
            }
            if (how == "itself") {
                executeItself();
            }
            if (how == "abort") {
                std::abort();
            }
            std::exit(3);
        }
        waitpid(child, &status, 0);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}
} // namespace

class Forks : public rtf::TestCase
{
public:
    void run() override
    {
        if (param() == "pass") {
            return;
        }
        if (param().rfind("start ", 0) == 0) {
            std::istringstream words(param());
            std::string how;
            std::string more;
            words >> more >> how;
            const int ended = start(how);
            if (ended != isChild) {
                report("ended " + std::to_string(ended));
                RTF_CHECK(!(words >> more), "it was asked to fail");
            }
            return;
        }
        if (split()) {
            report("from the child");
            return;
        }
        act(param());
        RTF_CHECK(param() != "fail", "it was asked to fail");
    }
};

RTF_PLUGIN(Forks);

extern "C" {
struct lua_State;
using lua_CFunction = int (*)(lua_State *);
void lua_pushboolean(lua_State *, int) __attribute__((weak));
void lua_pushcclosure(lua_State *, lua_CFunction, int) __attribute__((weak));
const char *lua_tolstring(lua_State *, int, std::size_t *) __attribute__((weak));
void lua_createtable(lua_State *, int, int) __attribute__((weak));
void lua_pushinteger(lua_State *, long long) __attribute__((weak));
void lua_setfield(lua_State *, int, const char *) __attribute__((weak));

static int luaSplit(lua_State *lua)
{
    lua_pushboolean(lua, split() ? 1 : 0);
    return 1;
}

static int luaAct(lua_State *lua)
{
    act(lua_tolstring(lua, 1, nullptr));
    return 0;
}

static int luaStart(lua_State *lua)
{
    lua_pushinteger(lua, start(lua_tolstring(lua, 1, nullptr)));
    return 1;
}

__attribute__((visibility("default"))) int luaopen_Forks(lua_State *lua)
{
    lua_createtable(lua, 0, 3);
    lua_pushcclosure(lua, luaSplit, 0);
    lua_setfield(lua, -2, "split");
    lua_pushcclosure(lua, luaAct, 0);
    lua_setfield(lua, -2, "act");
    lua_pushcclosure(lua, luaStart, 0);
    lua_setfield(lua, -2, "start");
    return 1;
}
}
