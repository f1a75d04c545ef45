// SPDX-License-Identifier: Apache-2.0
// Reports each CppUnit test as a case, and skips those that rtf does not select. C++11.
#ifndef RTF_INTERNAL_CPPUNITREPORTER_HPP
#define RTF_INTERNAL_CPPUNITREPORTER_HPP

#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <cppunit/Exception.h>
#include <cppunit/Message.h>
#include <cppunit/Protector.h>
#include <cppunit/SourceLine.h>
#include <cppunit/Test.h>
#include <cppunit/TestFailure.h>
#include <cppunit/TestListener.h>
#include <cppunit/TestResult.h>

#include <rtf/internal/SessionReports.hpp>

namespace rtf {
namespace internal {
namespace session {

// Makes names unique: the second `ArmTest::moves` is `ArmTest::moves #2`.
class UniqueNames
{
public:
    std::string add(const std::string &given)
    {
        const std::string name = given.empty() ? "unnamed" : given;
        const unsigned count = ++counts_[name];
        return count == 1 ? name : name + " #" + std::to_string(count);
    }

private:
    std::map<std::string, unsigned> counts_;
};

class CppUnitReporter : public CppUnit::TestListener
{
public:
    // One for all results of the program, so that names stay unique.
    static CppUnitReporter &instance()
    {
        static CppUnitReporter reporter;
        return reporter;
    }

    void attach_to(CppUnit::TestResult &result)
    {
        result.addListener(this);
        // The result deletes it.
        result.pushProtector(new Skipper(*this));
    }

    void startTestRun(CppUnit::Test *test, CppUnit::TestResult *) override
    {
        has_plan_ = true;
        std::vector<std::string> names;
        for (const std::string &name : names_of(*test)) {
            names.push_back(planned_names_.add(name));
        }
        plan(names);
    }

    void endTestRun(CppUnit::Test *, CppUnit::TestResult *) override
    {
        if (!Channel::instance().is_forked()) {
            exchange(packet("finished", ""));
        }
    }

    // A forked process starts and finishes no case.
    void startTest(CppUnit::Test *test) override
    {
        if (Channel::instance().is_forked()) {
            return;
        }
        case_ = started_names_.add(test->getName());
        // A test that its suite does not count, or the only one of a runner.
        if (has_plan_ && planned_.count(case_) == 0) {
            plan({case_});
        }
        is_skipping_ = exchange(packet("case-started", "\"name\":" + json_string(case_))) == "1";
    }

    void addFailure(const CppUnit::TestFailure &failure) override
    {
        const CppUnit::Exception &exception = *failure.thrownException();
        const CppUnit::Message message = exception.message();
        std::string more = ",\"case\":" + json_string(case_);
        const CppUnit::SourceLine line = exception.sourceLine();
        if (line.isValid()) {
            more += "," + location(line.fileName(), static_cast<unsigned>(line.lineNumber()));
        }
        std::string text = message.shortDescription() + "\n" + message.details();
        text.erase(text.find_last_not_of('\n') + 1);
        if (Channel::instance().is_forked()) {
            // Without rtf, only the program that runs the tests has a result.
            message_with("report", "in a forked process: " + text, more);
            return;
        }
        message_with(failure.isError() ? "error" : "failure", text, more + comparison(message));
    }

    void endTest(CppUnit::Test *) override
    {
        if (Channel::instance().is_forked()) {
            return;
        }
        if (!is_skipping_) {
            std::fflush(stdout); // otherwise a crash later loses it
            exchange(packet("case-finished", "\"name\":" + json_string(case_)));
        }
        is_skipping_ = false;
        case_.clear();
    }

private:
    // Surrounds set-up, test and tear-down of each test.
    class Skipper : public CppUnit::Protector
    {
    public:
        explicit Skipper(const CppUnitReporter &reporter) : reporter_(reporter) {}

        bool protect(const CppUnit::Functor &step, const CppUnit::ProtectorContext &) override
        {
            return reporter_.is_skipping_ || step();
        }

    private:
        const CppUnitReporter &reporter_;
    };

    // The tests that a test runs, in order.
    static std::vector<std::string> names_of(const CppUnit::Test &test)
    {
        const int children = test.getChildTestCount();
        if (children == 0) {
            return std::vector<std::string>(test.countTestCases() > 0 ? 1 : 0, test.getName());
        }
        std::vector<std::string> once;
        for (int child = 0; child < children; ++child) {
            const std::vector<std::string> names = names_of(*test.getChildTestAt(child));
            once.insert(once.end(), names.begin(), names.end());
        }
        // A RepeatedTest counts its tests several times.
        std::vector<std::string> all = once;
        const std::size_t count = static_cast<std::size_t>(test.countTestCases());
        while (!once.empty() && all.size() + once.size() <= count) {
            all.insert(all.end(), once.begin(), once.end());
        }
        return all;
    }

    // Announces cases, in several packets if they are many.
    void plan(const std::vector<std::string> &names)
    {
        std::string json;
        for (const std::string &name : names) {
            planned_.insert(name);
            if (json.size() >= longest_packet / 2) {
                exchange(packet("cases-planned", "\"names\":[" + json + "]"));
                json.clear();
            }
            json += (json.empty() ? "" : ",") + json_string(name);
        }
        if (!json.empty()) {
            exchange(packet("cases-planned", "\"names\":[" + json + "]"));
        }
    }

    // The number in a detail `Expected: 1`; false if there is none.
    static bool number(const CppUnit::Message &message, const std::string &title, std::string &json)
    {
        for (int index = 0; index < message.detailCount(); ++index) {
            const std::string detail = message.detailAt(index);
            if (detail.compare(0, title.size(), title) == 0) {
                const std::size_t start = detail.find(':') + 1;
                char *end = nullptr;
                json = json_number(std::strtod(detail.c_str() + start, &end));
                return *end == '\0';
            }
        }
        return false;
    }

    // The numbers of CPPUNIT_ASSERT_DOUBLES_EQUAL.
    static std::string comparison(const CppUnit::Message &message)
    {
        std::string expected;
        std::string actual;
        std::string delta;
        const bool is_found = number(message, "Expected", expected) &&
                              number(message, "Actual", actual) && number(message, "Delta", delta);
        return !is_found || delta == "null"
                   ? ""
                   : ",\"comparison\":{\"expected\":[" + expected + "],\"got\":[" + actual +
                         "],\"tolerance\":" + delta + "}";
    }

    UniqueNames planned_names_;
    UniqueNames started_names_;
    std::set<std::string> planned_;
    std::string case_;
    bool has_plan_ = false;
    bool is_skipping_ = false;
};

} // namespace session
} // namespace internal
} // namespace rtf

#endif
