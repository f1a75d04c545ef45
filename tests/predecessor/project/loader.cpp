// Loads a fixture, then a test with a parameter.
#include <cstdio>

#include <robottestingframework/ConsoleListener.h>
#include <robottestingframework/TestResult.h>
#include <robottestingframework/TestResultCollector.h>
#include <robottestingframework/TestRunner.h>
#include <robottestingframework/TestSuite.h>
#include <robottestingframework/TextOutputter.h>
#include <robottestingframework/dll/DllFixturePluginLoader.h>
#include <robottestingframework/dll/DllPluginLoader.h>

using namespace robottestingframework;
using namespace robottestingframework::plugin;

int main(int argc, char **argv)
{
    if (argc != 4) {
        return 2;
    }
    DllFixturePluginLoader fixtures;
    FixtureManager *fixture = fixtures.open(argv[1]);
    if (fixture == nullptr) {
        std::printf("%s\n", fixtures.getLastError().c_str());
        return 3;
    }
    DllPluginLoader tests;
    TestCase *test = tests.open(argv[2]);
    if (test == nullptr) {
        std::printf("%s\n", tests.getLastError().c_str());
        return 4;
    }
    test->setParam(argv[3]);
    fixture->setParam("rig");

    ConsoleListener console(true);
    TestResultCollector collector;
    TestResult result;
    result.addListener(&console);
    result.addListener(&collector);
    TestSuite suite("loaded");
    fixture->setDispatcher(&suite);
    suite.addFixtureManager(fixture);
    suite.addTest(test);
    TestRunner runner;
    runner.addTest(&suite);
    runner.run(result);

    TextOutputter outputter(collector);
    TestMessage problem;
    if (!outputter.write("loaded.txt", true, &problem)) {
        std::printf("%s\n", problem.getMessage().c_str());
        return 5;
    }
    return collector.failedCount() == 0 ? 0 : 1;
}
