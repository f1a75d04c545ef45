// SPDX-License-Identifier: Apache-2.0
// Prints a run's events on standard output.
#ifndef ROBOTTESTINGFRAMEWORK_CONSOLELISTENER_H
#define ROBOTTESTINGFRAMEWORK_CONSOLELISTENER_H

#include <cstdlib>
#include <iostream>
#include <string>

#if defined(_WIN32)
#include <io.h>
#else
#include <unistd.h>
#endif

#include "TestListener.h"
#include "internal/Lines.h"

namespace robottestingframework {

class ConsoleListener : public TestListener
{
public:
    // Verbose: with the source location of each message.
    ConsoleListener(bool verbose = false) : verbose_(verbose), colours_(is_coloured()) {}
    ~ConsoleListener() override {}

    // From now on, prints only errors and failures.
    void hideUncriticalMessages() { terse_ = true; }

    void addReport(const Test *test, TestMessage msg) override
    {
        if (!terse_) {
            tell("32", "[INFO]  ", test, msg);
        }
    }
    void addError(const Test *test, TestMessage msg) override { tell("31", "[ERROR] ", test, msg); }
    void addFailure(const Test *test, TestMessage msg) override
    {
        tell("31", "[FAIL]  ", test, msg);
    }
    void startTest(const Test *test) override { frame(internal::test_line(test, "started...")); }
    void endTest(const Test *test) override
    {
        frame(internal::test_line(test, test->succeeded() ? "passed!" : "failed!"));
    }
    void startTestSuite(const Test *test) override
    {
        frame(internal::suite_line(test, "started..."));
    }
    void endTestSuite(const Test *test) override
    {
        frame(internal::suite_line(test, test->succeeded() ? "passed!" : "failed!"));
    }
    void startTestRunner() override { frame("Starting test runner."); }
    void endTestRunner() override { frame("Ending test runner."); }

private:
    static bool is_coloured()
    {
        const char *const no = std::getenv("NO_COLOR");
#if defined(_WIN32)
        const bool terminal = _isatty(1) != 0;
#else
        const bool terminal = isatty(1) != 0;
#endif
        return terminal && (no == nullptr || *no == '\0');
    }

    std::string coloured(const char *colour, const std::string &text) const
    {
        return colours_ ? std::string("\033[") + colour + "m" + text + "\033[0m" : text;
    }

    void tell(const char *colour, const char *kind, const Test *test, const TestMessage &message)
    {
        std::cout << coloured(colour, kind) << internal::report_line(test, message) << std::endl;
        const std::string place = internal::place_line(message);
        if (verbose_ && !place.empty()) {
            std::cout << place << std::endl;
        }
    }

    void frame(const std::string &line)
    {
        if (!terse_) {
            std::cout << coloured("94", line) << std::endl;
        }
    }

    bool verbose_;
    bool terse_ = false;
    bool colours_;
};

} // namespace robottestingframework

#endif
