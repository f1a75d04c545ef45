// SPDX-License-Identifier: Apache-2.0
// The answers of robot-testing-framework 2.x's web listener: /status, a JSON object
// with the suite and the state of each test, and /update, HTML of the messages. Both
// are one line of valid JSON for any names.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_WEBSTATUS_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_WEBSTATUS_H

#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include <rtf/internal/SessionJson.hpp>

namespace robottestingframework {
namespace internal {

using ::rtf::internal::session::json_string;

// Text between HTML tags, without a character that JSON would escape.
inline std::string html_text(const std::string &text)
{
    std::string html;
    for (const char letter : text) {
        const bool is_plain = letter == ' ' || letter < 0 ||
                              (letter > ' ' && letter != '&' && letter != '<' && letter != '>' &&
                               letter != '"' && letter != '\'' && letter != '\\');
        html +=
            is_plain
                ? std::string(1, letter)
                : "&#" + std::to_string(static_cast<unsigned>(letter == 0 ? ' ' : letter)) + ";";
    }
    return html;
}

class WebStatus
{
public:
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
    // Kind: INFO, FAIL or ERROR.
    void reported(const char *kind, const std::string &name, const std::string &text)
    {
        keep(std::string("<br> [") + kind + "] (" + html_text(name) + ") " + html_text(text));
    }

    std::string status() const
    {
        std::string states;
        for (const State state : states_) {
            states += (states.empty() ? "" : ",") + std::to_string(static_cast<int>(state));
        }
        return "{\"name\":" + json_string(name_) + ",\"testStatus\":[" + states + "]}\n";
    }
    std::string update() const
    {
        std::string html;
        for (const std::string &line : lines_) {
            html += line;
        }
        return json_string(html) + "\n";
    }

private:
    enum class State { pending, running, failed, passed };

    void title(const std::string &text) { keep("<br> <b>" + html_text(text) + "</b>"); }

    void keep(const std::string &line)
    {
        lines_.push_back(line);
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
