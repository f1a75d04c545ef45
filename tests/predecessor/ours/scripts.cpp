// Runs Lua and Python scripts from one program.
#include <iostream>
#include <string>

#include <robottestingframework/ConsoleListener.h>
#include <robottestingframework/TestResult.h>
#include <robottestingframework/TestResultCollector.h>
#include <robottestingframework/TestRunner.h>
#include <robottestingframework/lua/LuaPluginLoader.h>
#include <robottestingframework/python/PythonPluginLoader.h>

using namespace robottestingframework;

static void add(TestRunner &runner, plugin::PluginLoader &loader, const char *file)
{
    TestCase *const test = loader.open(file);
    if (test == nullptr) {
        std::cout << "refused: " << loader.getLastError() << std::endl;
        return;
    }
    test->setParam("--rate \"1 0\"");
    test->setEnvironment("--robot simulator");
    runner.addTest(test);
}

int main(int argc, char **argv)
{
    if (argc != 4) {
        return 2;
    }
    plugin::LuaPluginLoader lua;
    plugin::PythonPluginLoader python;
    plugin::PythonPluginLoader broken;
    TestRunner runner;
    add(runner, lua, argv[1]);
    add(runner, python, argv[2]);
    add(runner, broken, argv[3]);

    ConsoleListener console;
    TestResultCollector collector;
    TestResult result;
    result.addListener(&console);
    result.addListener(&collector);
    runner.run(result);
    return collector.failedCount() == 1 ? 0 : 1;
}
