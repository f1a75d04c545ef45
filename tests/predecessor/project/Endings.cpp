#include "Endings.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <thread>
#include <vector>

#include <robottestingframework/TestAssert.h>
#include <robottestingframework/dll/Plugin.h>

using namespace robottestingframework;

ROBOTTESTINGFRAMEWORK_PREPARE_PLUGIN(Endings)

Endings::Endings() : TestCase("Endings") {}

bool Endings::setup(int argc, char **argv)
{
    how = argc > 1 ? argv[1] : "pass";
    if (how.compare(0, 4, "args") == 0) {
        arguments(how, argc, argv);
    }
    if (how == "setup-error") {
        ROBOTTESTINGFRAMEWORK_ASSERT_ERROR("the cable is out");
    }
    if (how == "setup-fail") {
        ROBOTTESTINGFRAMEWORK_ASSERT_FAIL("the arm is not at home");
    }
    if (how == "rename") {
        setName("a name of its own");
    }
    if (how == "repetition-three") {
        setRepetition(3);
    }
    ROBOTTESTINGFRAMEWORK_TEST_REPORT(Asserter::format("set up with %d arguments", argc));
    return how != "setup-false";
}

void Endings::arguments(const std::string &how, int argc, char **argv)
{
    if (how == "args") {
        const std::vector<std::string> expected{"args", "--name", "a b", "", "c"};
        const std::vector<std::string> got(argv + 1, argv + argc);
        ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_FALSE(got == expected, "arguments arrive");
        ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_FALSE(argv[0] == getName(), "the name is first");
    } else if (how == "args-many") {
        ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_FALSE(argc == 202, Asserter::format("%d", argc));
    } else if (how == "args-environment") {
        ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_FALSE(getEnvironment() == "--robot simulator",
                                                    getEnvironment());
    } else if (how == "args-param") {
        ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_FALSE(getParam() == "args-param --x \"1 2\"",
                                                    getParam());
    }
}

void Endings::tearDown()
{
    if (const char *log = std::getenv("BENCH_LOG")) {
        FILE *file = std::fopen(log, "a");
        std::fprintf(file, "torn down\n");
        std::fclose(file);
    }
    if (how == "teardown-error") {
        ROBOTTESTINGFRAMEWORK_ASSERT_ERROR("the arm cannot be parked");
    }
    if (how == "teardown-fail") {
        ROBOTTESTINGFRAMEWORK_ASSERT_FAIL("the arm is not parked");
    }
}

void Endings::run()
{
    if (const char *log = std::getenv("BENCH_LOG")) {
        FILE *file = std::fopen(log, "a");
        std::fprintf(file, "ran\n");
        std::fclose(file);
    }
    end(how);
}

void Endings::end(const std::string &how)
{
    const int one = 1;
    const int two = 2;
    if (how == "assert-error") {
        ROBOTTESTINGFRAMEWORK_ASSERT_ERROR("no answer from the motor");
    } else if (how == "assert-error-if-false") {
        ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_FALSE(one == two, "no answer from the motor");
    } else if (how == "assert-error-if-true") {
        ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_TRUE((one < two), "no answer from the motor");
    } else if (how == "assert-fail") {
        ROBOTTESTINGFRAMEWORK_ASSERT_FAIL("the arm fell");
    } else if (how == "assert-fail-if-false") {
        ROBOTTESTINGFRAMEWORK_ASSERT_FAIL_IF_FALSE(one == two, "the arm fell");
    } else if (how == "assert-fail-if-true") {
        ROBOTTESTINGFRAMEWORK_ASSERT_FAIL_IF_TRUE((one < two), "the arm fell");
    } else if (how == "fail-if-false") {
        ROBOTTESTINGFRAMEWORK_TEST_FAIL_IF_FALSE(one == two, "one is two");
    } else if (how == "fail-if-false-holds") {
        ROBOTTESTINGFRAMEWORK_TEST_FAIL_IF_FALSE(one < two, "one is less than two");
    } else if (how == "fail-if-true") {
        ROBOTTESTINGFRAMEWORK_TEST_FAIL_IF_TRUE((one < two), "one is less than two");
    } else if (how == "fail-if-true-comparison") {
        ROBOTTESTINGFRAMEWORK_TEST_FAIL_IF_TRUE(two == one, "two is one");
    } else if (how == "check") {
        ROBOTTESTINGFRAMEWORK_TEST_CHECK(one == two, "one is two");
    } else if (how == "fail-then-error") {
        ROBOTTESTINGFRAMEWORK_TEST_FAIL_IF_FALSE(one == two, "the first problem");
        ROBOTTESTINGFRAMEWORK_ASSERT_ERROR("the second problem");
    } else if (how == "failed") {
        failed();
    } else if (how == "result") {
        getResult()->addFailure(this, TestMessage("by hand", "straight to the result", "", 0));
    } else if (how == "standard") {
        throw std::runtime_error("joint 9");
    } else if (how == "fixture-exception") {
        throw FixtureException(TestMessage("no rig"));
    } else if (how == "integer") {
        throw 42;
    } else if (how == "exit") {
        std::exit(0);
    } else if (how == "abort") {
        std::abort();
    } else if (how == "crash") {
        *static_cast<volatile int *>(nullptr) = 0;
    } else if (how == "long") {
        const std::string text = Asserter::format("%s end", std::string(1000, 'x').c_str());
        ROBOTTESTINGFRAMEWORK_ASSERT_FAIL_IF_FALSE(text.size() == 1004, "a text is cut");
    } else if (how == "collapse") {
        const std::string marks = std::getenv("BENCH_LOG");
        if (!std::ifstream(marks + ".go")) {
            std::ofstream(marks + ".go");
            while (!std::ifstream(marks + ".told")) {
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
            }
        }
    } else if (how == "rename") {
        ROBOTTESTINGFRAMEWORK_ASSERT_FAIL_IF_FALSE(getName() == "a name of its own", getName());
    }
}
