// SPDX-License-Identifier: Apache-2.0
// The lines of a run on the console and in text files.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_LINES_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_LINES_H

#include <string>

#include "../Test.h"
#include "../TestMessage.h"
#include "../TestResultCollector.h"

namespace robottestingframework {
namespace internal {

// (name) message: detail
inline std::string report_line(const Test *test, const TestMessage &message)
{
    std::string line = "(" + test->getName() + ") " + message.getMessage();
    if (!message.getDetail().empty()) {
        line += ": " + message.getDetail();
    }
    return line;
}

// The location of a message; empty if unknown.
inline std::string place_line(const TestMessage &message)
{
    if (message.getSourceFileName().empty()) {
        return std::string();
    }
    return message.getSourceFileName() + " at " + std::to_string(message.getSourceLineNumber()) +
           ".";
}

inline std::string test_line(const Test *test, const std::string &what)
{
    return "Test case " + test->getName() + " " + what;
}

inline std::string suite_line(const Test *test, const std::string &what)
{
    return "Test suite " + test->getName() + " " + what;
}

// The block of counts at the end.
inline std::string summary_lines(TestResultCollector &collector)
{
    const auto line = [](const char *what, unsigned int count) {
        return std::string(what) + ": " + std::to_string(count) + "\n";
    };
    return "\n---------- summary -----------\n" +
           line("Total number of test suites  ", collector.suiteCount()) +
           line("Number of passed test suites ", collector.passedSuiteCount()) +
           line("Number of failed test suites ", collector.failedSuiteCount()) +
           line("Total number of test cases   ", collector.testCount()) +
           line("Number of passed test cases  ", collector.passedCount()) +
           line("Number of failed test cases  ", collector.failedCount());
}

} // namespace internal
} // namespace robottestingframework

#endif
