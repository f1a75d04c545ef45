// SPDX-License-Identifier: Apache-2.0
// The functions behind the macros in TestAssert.h.
#ifndef ROBOTTESTINGFRAMEWORK_ASSERTER_H
#define ROBOTTESTINGFRAMEWORK_ASSERTER_H

#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "Exception.h"
#include "TestCase.h"
#include "TestMessage.h"
#include "TestSuite.h"

#define ROBOTTESTINGFRAMEWORK_NORETURN [[noreturn]]

namespace robottestingframework {

class Asserter
{
public:
    // Ends the step: the robot is wrong.
    ROBOTTESTINGFRAMEWORK_NORETURN static void fail(TestMessage msg)
    {
        throw TestFailureException(msg);
    }
    // The same unless the condition holds.
    static void fail(bool condition, TestMessage msg)
    {
        if (!condition) {
            fail(msg);
        }
    }

    // Ends the step: the bench is wrong.
    ROBOTTESTINGFRAMEWORK_NORETURN static void error(TestMessage msg)
    {
        throw TestErrorException(msg);
    }
    // The same unless the condition holds.
    static void error(bool condition, TestMessage msg)
    {
        if (!condition) {
            error(msg);
        }
    }

    // Reports for information only.
    static void report(TestMessage msg, TestSuite *testsuite)
    {
        if (testsuite == nullptr) {
            error(TestMessage("a report outside of a test suite", internal::text_of(msg)));
        }
        if (testsuite->getResult() != nullptr) {
            testsuite->getResult()->addReport(testsuite, msg);
        }
    }
    static void report(TestMessage msg, TestCase *testcase)
    {
        if (TestResult *result = result_of(msg, testcase)) {
            result->addReport(testcase, msg);
        }
    }

    // A failure of the test unless the condition holds; the test continues.
    static void testFail(bool condition, TestMessage msg, TestCase *testcase)
    {
        TestResult *const result = result_of(msg, testcase);
        if (condition) {
            return;
        }
        testcase->failed();
        if (result != nullptr) {
            result->addFailure(testcase, msg);
        }
    }

    // The same; also reports a condition that holds.
    static void testCheck(bool condition, TestMessage msg, TestCase *testcase)
    {
        if (condition) {
            report(internal::as_check(msg), testcase);
        } else {
            testFail(condition, msg, testcase);
        }
    }

    // A text of any length in the format of std::printf.
    static std::string format(const char *msg, ...)
    {
        va_list arguments;
        va_start(arguments, msg);
        va_list again;
        va_copy(again, arguments);
        const int length = std::vsnprintf(nullptr, 0, msg, arguments);
        va_end(arguments);
        std::vector<char> text(length < 0 ? 1 : static_cast<std::size_t>(length) + 1);
        if (length >= 0) {
            std::vsnprintf(text.data(), text.size(), msg, again);
        }
        va_end(again);
        return std::string(text.data(), text.size() - 1);
    }

private:
    static TestResult *result_of(const TestMessage &msg, TestCase *testcase)
    {
        if (testcase == nullptr) {
            error(TestMessage("a check or report outside of a test case", internal::text_of(msg)));
        }
        return testcase->getResult();
    }
};

} // namespace robottestingframework

#endif
