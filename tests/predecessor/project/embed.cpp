// A program that runs tests in its own process with all classes. It prints one line for
// each event that listeners get, for the scenario in its argument.
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include <robottestingframework/Arguments.h>
#include <robottestingframework/ConsoleListener.h>
#include <robottestingframework/FixtureManager.h>
#include <robottestingframework/ResultEvent.h>
#include <robottestingframework/TestAssert.h>
#include <robottestingframework/TestCase.h>
#include <robottestingframework/TestListener.h>
#include <robottestingframework/TestResult.h>
#include <robottestingframework/TestResultCollector.h>
#include <robottestingframework/TestRunner.h>
#include <robottestingframework/TestSuite.h>
#include <robottestingframework/TextOutputter.h>

using namespace robottestingframework;

namespace {

void line(const std::string &text)
{
    std::cout << text << std::endl;
}

// Prints tests and their messages; the framework's own wording is not compared.
class Trace : public TestListener
{
public:
    void addReport(const Test *test, TestMessage msg) override { say("report", test, msg); }
    void addError(const Test *test, TestMessage msg) override { say("error", test, msg); }
    void addFailure(const Test *test, TestMessage msg) override { say("failure", test, msg); }
    void startTest(const Test *test) override { line("start test " + test->getName()); }
    void endTest(const Test *test) override
    {
        line("end test " + test->getName() + (test->succeeded() ? " passed" : " failed"));
    }
    void startTestSuite(const Test *test) override { line("start suite " + test->getName()); }
    void endTestSuite(const Test *test) override
    {
        line("end suite " + test->getName() + (test->succeeded() ? " passed" : " failed"));
    }
    void startTestRunner() override { line("start runner"); }
    void endTestRunner() override { line("end runner"); }

private:
    // Messages of a suite are the framework's, except the reason of a collapse.
    static void say(const std::string &kind, const Test *test, TestMessage msg)
    {
        const bool own = test->getName() != "suite" || msg.getDetail() == "the rig fell";
        line(kind + " " + test->getName() + (own ? " " + msg.getDetail() : ""));
    }
};

class Scenario : public TestCase
{
public:
    Scenario(const std::string &name, const std::string &ending = "", TestSuite *suite = nullptr)
        : TestCase(name), ending(ending), suite(suite)
    {
    }

    bool setup(int argc, char **argv) override
    {
        line(getName() + " setup " + std::to_string(argc) + " " + argv[0]);
        for (int index = 1; index < argc; ++index) {
            line(std::string("argument <") + argv[index] + ">");
        }
        if (ending == "setup-error") {
            ROBOTTESTINGFRAMEWORK_ASSERT_ERROR("set-up");
        }
        return ending != "setup-false";
    }

    void run() override
    {
        line(getName() + " run");
        ROBOTTESTINGFRAMEWORK_TEST_REPORT("running");
        ROBOTTESTINGFRAMEWORK_TEST_CHECK(1 < 2, "order");
        if (ending == "check") {
            ROBOTTESTINGFRAMEWORK_TEST_CHECK(2 < 1, "wrong order");
            ROBOTTESTINGFRAMEWORK_TEST_FAIL_IF_FALSE(2 < 1, "still wrong");
        } else if (ending == "error") {
            ROBOTTESTINGFRAMEWORK_ASSERT_ERROR("an error");
        } else if (ending == "fail") {
            ROBOTTESTINGFRAMEWORK_ASSERT_FAIL("a failure");
        } else if (ending == "standard") {
            throw std::runtime_error("thrown");
        } else if (ending == "integer") {
            throw 42;
        } else if (ending == "collapse") {
            suite->fixtureCollapsed(TestMessage("during the run", "the rig fell", "", 0));
        } else if (ending == "interrupt") {
            suite->interrupt();
        }
    }

    void tearDown() override
    {
        line(getName() + " tearDown");
        if (ending == "teardown") {
            ROBOTTESTINGFRAMEWORK_ASSERT_ERROR("tear-down");
        }
    }

private:
    std::string ending;
    TestSuite *suite;
};

class Fixture : public FixtureManager
{
public:
    Fixture(FixtureEvents *events, const std::string &name, const std::string &ending = "")
        : FixtureManager(events, name + " param"), name(name), ending(ending)
    {
    }

    bool setup(int argc, char **argv) override
    {
        line(name + " setup " + std::to_string(argc) + " " + argv[argc - 1]);
        if (ending == "setup-throws") {
            throw FixtureException(TestMessage("no power"));
        }
        return ending != "setup-false";
    }

    bool check() override
    {
        line(name + " check");
        ++checks;
        return !(ending == "check-once" && checks == 2) && !(ending == "check-false" && checks > 1);
    }

    void tearDown() override
    {
        line(name + " tearDown");
        if (ending == "teardown-throws") {
            throw FixtureException(TestMessage("cannot park"));
        }
    }

private:
    std::string name;
    std::string ending;
    int checks = 0;
};

class Bench
{
public:
    explicit Bench(const std::string &what) : suite("suite"), what(what)
    {
        result.addListener(&trace);
        result.addListener(&collector);
    }

    int run()
    {
        TestRunner runner;
        const std::string prefix = what.substr(0, what.find('/'));
        const std::string ending =
            what.find('/') == std::string::npos ? "" : what.substr(what.find('/') + 1);
        Scenario first(ending == "blank" ? "first test" : "first",
                       prefix == "test" || prefix == "suite" ? ending : "", &suite);
        Scenario second("second", prefix == "last" ? ending : "", &suite);
        Fixture one(&suite, "one", prefix == "fixture" ? ending : "");
        Fixture two(&suite, "two", prefix == "fixture2" ? ending : "");
        TestSuite other("other");
        Scenario third("third");
        other.addTest(&third);
        if (prefix == "test") {
            runner.addTest(&first);
        } else {
            suite.addFixtureManager(&one);
            suite.addFixtureManager(&two);
            suite.addTest(&first);
            suite.addTest(&second);
            runner.addTest(&suite);
            runner.addTest(&other);
        }
        if (ending == "repetition") {
            first.setRepetition(3);
        }
        if (ending == "param") {
            first.setParam("--a \"b c\"  d\"e f\"g");
        }
        runner.run(result);
        count();
        return 0;
    }

private:
    void count()
    {
        line("tests " + std::to_string(collector.testCount()) + " passed " +
             std::to_string(collector.passedCount()) + " failed " +
             std::to_string(collector.failedCount()));
        line("suites " + std::to_string(collector.suiteCount()) + " passed " +
             std::to_string(collector.passedSuiteCount()) + " failed " +
             std::to_string(collector.failedSuiteCount()));
    }

    TestResult result;
    Trace trace;
    TestResultCollector collector;
    TestSuite suite;
    std::string what;
};

} // namespace

int main(int argc, char **argv)
{
    return argc == 2 ? Bench(argv[1]).run() : 2;
}
