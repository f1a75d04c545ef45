// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <rtf/TestCase.hpp>

/// Forks a child that returns from `run`, as its parent does what the parameter says.
/// As a Lua module, offers the same as the function `split`.
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
} // namespace

class Forks : public rtf::TestCase
{
public:
    void run() override
    {
        if (param() == "pass") {
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

__attribute__((visibility("default"))) int luaopen_Forks(lua_State *lua)
{
    lua_createtable(lua, 0, 2);
    lua_pushcclosure(lua, luaSplit, 0);
    lua_setfield(lua, -2, "split");
    lua_pushcclosure(lua, luaAct, 0);
    lua_setfield(lua, -2, "act");
    return 1;
}
}
