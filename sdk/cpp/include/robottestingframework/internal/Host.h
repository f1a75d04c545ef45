// SPDX-License-Identifier: Apache-2.0
// The connection to the host process that has loaded the plug-in.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_HOST_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_HOST_H

#include <cstdint>
#include <string>

#include <rtf/plugin.h>

#include "../TestListener.h"
#include "../TestMessage.h"

namespace robottestingframework {
namespace internal {

inline rtf_text to_text(const std::string &text)
{
    rtf_text result;
    result.data = text.data();
    result.length = text.size();
    return result;
}

inline std::string from_text(rtf_text text)
{
    return text.length == 0 ? std::string() : std::string(text.data, text.length);
}

inline void send_to_host(const rtf_host &host, std::int32_t kind, const TestMessage &content)
{
    const std::string text = text_of(content);
    const std::string file = content.getSourceFileName();
    rtf_message message = rtf_message();
    message.size = sizeof message;
    message.kind = kind;
    message.text = to_text(text);
    message.file = file.empty() ? nullptr : file.c_str();
    message.line = content.getSourceLineNumber();
    host.message(host.context, &message);
}

// Sends the messages in a test's result to the host.
class HostListener : public TestListener
{
public:
    explicit HostListener(const rtf_host &host) : host_(host) {}

    void addReport(const Test *, TestMessage msg) override
    {
        send_to_host(host_, is_check(msg) ? RTF_MESSAGE_CHECK : RTF_MESSAGE_REPORT, msg);
    }
    void addError(const Test *, TestMessage msg) override
    {
        send_to_host(host_, RTF_MESSAGE_ERROR, msg);
    }
    void addFailure(const Test *, TestMessage msg) override
    {
        send_to_host(host_, RTF_MESSAGE_FAILURE, msg);
    }

private:
    const rtf_host &host_;
};

} // namespace internal
} // namespace robottestingframework

#endif
