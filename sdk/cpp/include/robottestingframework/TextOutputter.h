// SPDX-License-Identifier: Apache-2.0
// Writes a collector's events into a text file.
#ifndef ROBOTTESTINGFRAMEWORK_TEXTOUTPUTTER_H
#define ROBOTTESTINGFRAMEWORK_TEXTOUTPUTTER_H

#include <cerrno>
#include <cstring>
#include <fstream>
#include <ostream>
#include <string>

#include "ResultEvent.h"
#include "TestMessage.h"
#include "TestResultCollector.h"
#include "internal/Lines.h"

namespace robottestingframework {

class TextOutputter
{
public:
    // Verbose: with the source location of each message.
    TextOutputter(TestResultCollector &collector, bool verbose = false)
        : collector_(collector), verbose_(verbose)
    {
    }
    virtual ~TextOutputter() {}

    // Summary: with the counts at the end. False: it could not be written; the reason
    // is in the message, if one is given.
    bool write(std::string filename, bool summary, TestMessage *errorMsg = nullptr)
    {
        errno = 0;
        std::ofstream file(filename);
        for (ResultEvent *event : collector_.getResults()) {
            write(file, *event);
        }
        if (summary) {
            file << internal::summary_lines(collector_);
        }
        file.close();
        if (!file && errorMsg != nullptr) {
            *errorMsg = TestMessage("cannot write " + filename, std::strerror(errno));
        }
        return static_cast<bool>(file);
    }

private:
    template <class Kind>
    static bool is(ResultEvent &event)
    {
        return dynamic_cast<Kind *>(&event) != nullptr;
    }

    void write(std::ostream &file, ResultEvent &event) const
    {
        const Test *const test = event.getTest();
        const std::string end = event.getMessage().getMessage() + "!";
        if (is<ResultEventReport>(event)) {
            tell(file, "[INFO]  ", event);
        } else if (is<ResultEventError>(event)) {
            tell(file, "[ERROR] ", event);
        } else if (is<ResultEventFailure>(event)) {
            tell(file, "[FAIL]  ", event);
        } else if (is<ResultEventStartTest>(event)) {
            file << internal::test_line(test, "started...") << "\n";
        } else if (is<ResultEventEndTest>(event)) {
            file << internal::test_line(test, end) << "\n";
        } else if (is<ResultEventStartSuite>(event)) {
            file << internal::suite_line(test, "started...") << "\n";
        } else if (is<ResultEventEndSuite>(event)) {
            file << internal::suite_line(test, end) << "\n";
        }
    }

    void tell(std::ostream &file, const char *kind, ResultEvent &event) const
    {
        file << kind << internal::report_line(event.getTest(), event.getMessage()) << "\n";
        const std::string place = internal::place_line(event.getMessage());
        if (verbose_ && !place.empty()) {
            file << place << "\n\n";
        }
    }

    TestResultCollector &collector_;
    bool verbose_;
};

} // namespace robottestingframework

#endif
