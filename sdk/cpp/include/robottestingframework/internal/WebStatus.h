// SPDX-License-Identifier: Apache-2.0
// The answers of robot-testing-framework 2.x's web listener: /status, a JSON object
// with the suite and the state of each test, and /update, HTML of the messages. Both
// are one line that ends with \r\n: clients of 2.x strip one character, which was the \r
// of its chunk.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_WEBSTATUS_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_WEBSTATUS_H

#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include <rtf/internal/SessionJson.hpp>

#include "../TestMessage.h"

namespace robottestingframework {
namespace internal {

using ::rtf::internal::session::json_string;

inline std::string html_letter(char letter)
{
    switch (letter) {
    case '&':
        return "&amp;";
    case '<':
        return "&lt;";
    case '>':
        return "&gt;";
    case '"':
        return "&quot;";
    case '\'':
        return "&apos;";
    case '\n':
        return "<br>";
    default:
        return std::string(1, letter < ' ' ? ' ' : letter);
    }
}

// Text between HTML tags. A byte that is not UTF-8 is replaced.
inline std::string html_text(const std::string &text)
{
    std::string html;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = ::rtf::internal::session::utf8_length(text, at);
        if (length == 1) {
            html += html_letter(text[at]);
        } else {
            html += length == 0 ? "\xEF\xBF\xBD" : text.substr(at, length);
        }
        at += length == 0 ? 1 : length;
    }
    return html;
}

class WebStatus
{
public:
    void runner(bool starts) { title(starts ? "Starting test runner." : "Ending test runner."); }
    void suite_started(const std::string &name, std::size_t tests)
    {
        name_ = name;
        states_.assign(tests, State::pending);
        next_ = 0;
        is_in_suite_ = true;
        title("Test suite " + name + " started...");
    }
    void suite_ended(const std::string &name, bool passed)
    {
        is_in_suite_ = false;
        title("Test suite " + name + (passed ? " passed!" : " failed!"));
    }
    void test_started(const std::string &name)
    {
        if (!is_in_suite_) {
            name_ = name;
            states_.clear();
            next_ = 0;
        }
        if (next_ == states_.size()) {
            states_.push_back(State::pending);
        }
        states_[next_++] = State::running;
        title("Test case " + name + " started...");
    }
    void test_ended(const std::string &name, bool passed)
    {
        if (next_ > 0) {
            states_[next_ - 1] = passed ? State::passed : State::failed;
        }
        title("Test case " + name + (passed ? " passed!" : " failed!"));
    }
    // Word: INFO, FAIL or ERROR.
    void reported(const std::string &word, const std::string &name, const TestMessage &message)
    {
        const std::string detail = message.getDetail();
        const std::string text = message.getMessage() + (detail.empty() ? "" : " : ") + detail;
        // The texts of messages are in one column.
        const std::string blanks = word == "ERROR" ? "&nbsp;" : "&nbsp;&nbsp;";
        keep(bold(word == "INFO" ? "green" : "red", "[" + word + "]" + blanks) + " (" +
             html_text(name) + ") " + html_text(text) + ".");
    }

    std::string status() const
    {
        std::string states;
        for (const State state : states_) {
            states += (states.empty() ? "" : ",") + std::to_string(static_cast<int>(state));
        }
        return "{\"name\":" + json_string(name_) + ",\"testStatus\":[" + states + "]}\r\n";
    }
    std::string update() const
    {
        std::string html;
        for (const std::string &line : lines_) {
            html += line;
        }
        return html + "\r\n";
    }

private:
    enum class State { pending, running, failed, passed };

    static std::string bold(const std::string &colour, const std::string &html)
    {
        return "<font color=\"" + colour + "\"><b>" + html + "</b></font>";
    }

    void title(const std::string &text) { keep(bold("blue", " " + html_text(text) + " ")); }

    void keep(const std::string &html)
    {
        lines_.push_back("<br> " + html);
        if (lines_.size() > 500) {
            lines_.pop_front();
        }
    }

    std::string name_;
    std::vector<State> states_;
    // The number of started tests of the suite.
    std::size_t next_ = 0;
    bool is_in_suite_ = false;
    std::deque<std::string> lines_;
};

} // namespace internal
} // namespace robottestingframework

#endif
