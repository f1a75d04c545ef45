// SPDX-License-Identifier: Apache-2.0
// Messages to the host, and the exception that unwinds a plug-in.
#ifndef RTF_INTERNAL_MESSAGE_HPP
#define RTF_INTERNAL_MESSAGE_HPP

#include <cstddef>
#include <string>
#include <string_view>

#include <rtf/internal/Host.hpp>
#include <rtf/internal/Location.hpp>

namespace rtf {
namespace internal {

// Ends a case or a step after a failed assertion, an error, a skip, or a stop request. Not
// a std::exception: a plug-in that catches those must not swallow it.
struct Stop
{
    // A critical assertion or a stop request: not only the innermost case ends.
    bool ends_test = false;
};

enum class Critical { no, yes };

// A message of any type, with its size and location.
template <class Message>
Message message_at(Location here)
{
    Message message{};
    message.size = sizeof message;
    message.file = here.file;
    message.line = here.line;
    return message;
}

inline void send(int32_t kind, std::string_view text, Location here,
                 const rtf_comparison *comparison = nullptr, Critical critical = Critical::no)
{
    auto message = message_at<rtf_message>(here);
    message.kind = kind;
    message.critical = critical == Critical::yes ? 1 : 0;
    message.text = to_text(text);
    message.comparison = comparison;
    host().message(host().context, &message);
}

inline void report(Location here, std::string_view text)
{
    send(RTF_MESSAGE_REPORT, text, here);
}

inline bool check(Location here, bool holds, std::string_view text)
{
    send(holds ? RTF_MESSAGE_CHECK : RTF_MESSAGE_FAILURE, text, here);
    return holds;
}

inline void require(Location here, bool holds, std::string_view text)
{
    if (!check(here, holds, text)) {
        throw Stop();
    }
}

inline void require_critical(Location here, bool holds, std::string_view text)
{
    if (!holds) {
        send(RTF_MESSAGE_FAILURE, text, here, nullptr, Critical::yes);
        throw Stop{true};
    }
    send(RTF_MESSAGE_CHECK, text, here);
}

[[noreturn]] inline void fail(Location here, std::string_view text)
{
    send(RTF_MESSAGE_FAILURE, text, here);
    throw Stop();
}

[[noreturn]] inline void error(Location here, std::string_view text)
{
    send(RTF_MESSAGE_ERROR, text, here);
    throw Stop();
}

// The host's table, if it has the function at this offset: that of an older host is shorter.
inline const rtf_host &host_with(std::size_t function, Location here, std::string_view feature)
{
    const rtf_host &table = host();
    if (table.size <= function) {
        error(here, "this rtf is too old for " + std::string(feature) +
                        ": its plug-in interface is 1." + std::to_string(table.abi_minor));
    }
    return table;
}

// The host's table, if it has the functions of version 1.3.
inline const rtf_host &host_since_1_3(Location here, std::string_view feature)
{
    return host_with(offsetof(rtf_host, ask), here, feature);
}

} // namespace internal
} // namespace rtf

#endif
