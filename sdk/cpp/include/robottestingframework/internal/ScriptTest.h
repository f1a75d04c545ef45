// SPDX-License-Identifier: Apache-2.0
// A test in a scripting language. The runner runs it in the language's host, in a
// separate process; this class adds the events of its journal to the result.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_SCRIPTTEST_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_SCRIPTTEST_H

#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "../Exception.h"
#include "../PluginLoader.h"
#include "../TestCase.h"
#include "JsonFields.h"
#include "Program.h"

// The runner's path, which the CMake package defines.
#ifndef ROBOTTESTINGFRAMEWORK_RUNNER
#define ROBOTTESTINGFRAMEWORK_RUNNER "rtf"
#endif

namespace robottestingframework {
namespace internal {

inline std::string file_text(const std::string &path)
{
    std::ifstream file(path);
    return std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

class ScriptTest : public TestCase
{
public:
    explicit ScriptTest(const std::string &file) : TestCase(name_of(file)), file_(file) {}

    // The problem with the script, empty if it can run.
    std::string problem()
    {
        const TemporaryFolder folder;
        const std::string output = folder.path() + "/output";
        Program program;
        const int code =
            program.run({ROBOTTESTINGFRAMEWORK_RUNNER, "check", "--color=never", file_}, output);
        if (code == 0) {
            return std::string();
        }
        return code < 0 ? program.error() : file_text(output);
    }

    void run() override
    {
        const TemporaryFolder folder;
        const int code = program_.run({ROBOTTESTINGFRAMEWORK_RUNNER, "run", "--color=never",
                                       "--results=" + folder.path(), "--param=" + getParam(),
                                       "--environment=" + getEnvironment(), file_},
                                      folder.path() + "/output");
        std::ifstream journal(folder.path() + "/latest/events.jsonl");
        bool finished = false;
        for (std::string line; std::getline(journal, line);) {
            JsonFields event(line);
            if (event["type"] == "message") {
                tell(event);
            } else if (event["type"] == "test-finished") {
                finished = true;
                judge(event);
            }
        }
        if (!finished) {
            const std::string words = file_text(folder.path() + "/output");
            throw TestErrorException(
                TestMessage("the script was not run", code < 0 ? program_.error() : words));
        }
    }

    void interrupt() override
    {
        TestCase::interrupt();
        program_.interrupt();
    }

private:
    static std::string name_of(const std::string &file)
    {
        return file.substr(file.find_last_of('/') + 1);
    }

    void tell(JsonFields &event)
    {
        const std::string kind = event["message.kind"];
        const std::string line = event["message.location.line"];
        const TestMessage message =
            said(verb(kind), event["message.text"], event["message.location.file"].c_str(),
                 line.empty() ? 0 : std::stoi(line));
        if (kind == "failure") {
            getResult()->addFailure(this, message);
        } else if (kind == "error") {
            getResult()->addError(this, message);
        } else {
            getResult()->addReport(this, kind == "check" ? as_check(message) : message);
        }
    }

    // The words of the macros.
    static std::string verb(const std::string &kind)
    {
        if (kind == "report") {
            return "reports";
        }
        return kind == "check" || kind == "failure" ? "checks" : kind;
    }

    // Reports an end of the test that has no message.
    void judge(JsonFields &event)
    {
        const std::string verdict = event["verdict"];
        if (verdict == "passed" || getResult()->hasProblem(this)) {
            return;
        }
        const TestMessage message(verdict, event["reason"]);
        if (verdict == "failed") {
            getResult()->addFailure(this, message);
        } else {
            getResult()->addError(this, message);
        }
    }

    std::string file_;
    Program program_;
};

// The base class of all loaders of scripting languages.
class ScriptLoader : public plugin::PluginLoader
{
public:
    TestCase *open(const std::string filename) override
    {
        close();
        error_.clear();
        std::unique_ptr<ScriptTest> test(new ScriptTest(filename));
        error_ = test->problem();
        if (error_.empty()) {
            test_ = std::move(test);
        }
        return test_.get();
    }
    void close() override { test_.reset(); }
    std::string getLastError() override { return error_; }

private:
    std::unique_ptr<ScriptTest> test_;
    std::string error_;
};

} // namespace internal
} // namespace robottestingframework

#endif
