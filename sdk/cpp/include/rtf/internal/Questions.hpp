// SPDX-License-Identifier: Apache-2.0
// Questions to an operator.
#ifndef RTF_INTERNAL_QUESTIONS_HPP
#define RTF_INTERNAL_QUESTIONS_HPP

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include <rtf/internal/Message.hpp>
#include <rtf/internal/Wait.hpp>

namespace rtf {
namespace internal {

constexpr Seconds kAnswerTime = std::chrono::minutes(5);

struct Question
{
    std::string_view text;
    const std::vector<std::string> &choices;
    Seconds timeout;
    std::string_view default_answer;
    std::string_view picture;
};

// Asks and waits. A stop request ends the test; without an answer, the host has reported an
// error, which ends the step.
inline std::string ask(Location here, const Question &question)
{
    std::vector<rtf_text> choices;
    choices.reserve(question.choices.size());
    for (const std::string &choice : question.choices) {
        choices.push_back(to_text(choice));
    }
    auto message = message_at<rtf_question>(here);
    message.text = to_text(question.text);
    message.choices = choices.data();
    message.choice_count = choices.size();
    message.default_answer = to_text(question.default_answer);
    message.timeout = question.timeout.count();
    message.picture = to_text(question.picture);
    const rtf_host &table = host_since_1_3(here, "questions");
    rtf_text answer = to_text("");
    if (table.ask(table.context, &message, &answer) != RTF_DONE) {
        throw Stop{interrupted()};
    }
    return from_text(answer);
}

inline void instruct(Location here, std::string_view text, std::string_view picture,
                     Seconds timeout, std::string_view default_answer)
{
    const std::vector<std::string> choices{"done", "cannot"};
    if (ask(here, Question{text, choices, timeout, default_answer, picture}) != "done") {
        error(here, "the operator cannot do this: " + std::string(text));
    }
}

} // namespace internal
} // namespace rtf

#endif
