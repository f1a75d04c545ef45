// SPDX-License-Identifier: Apache-2.0
// Sleeping and waiting that end when the plug-in is asked to stop.
#ifndef RTF_INTERNAL_WAIT_HPP
#define RTF_INTERNAL_WAIT_HPP

#include <chrono>
#include <string>
#include <string_view>

#include <rtf/internal/Message.hpp>
#include <rtf/internal/Number.hpp>

namespace rtf {
namespace internal {

inline bool interrupted()
{
    return host().interrupted(host().context) != 0;
}

inline void sleep(std::chrono::duration<double> duration)
{
    if (host().wait(host().context, duration.count()) != 0) {
        throw Stop();
    }
}

// Asks every 10 ms. When the time is over this is a failed assertion.
template <class Condition>
bool wait_until(Location here, Condition &&condition, std::chrono::duration<double> timeout,
                std::string_view what)
{
    using Clock = std::chrono::steady_clock;
    using Seconds = std::chrono::duration<double>;
    const auto start = Clock::now();
    for (;;) {
        const auto value = condition();
        if (static_cast<bool>(value)) {
            return true;
        }
        const Seconds left = timeout - Seconds(Clock::now() - start);
        if (!(left.count() > 0)) {
            std::string text(what);
            text += ": not within " + number(timeout.count()) + " s";
            const std::string last = last_value(value);
            fail(here, last.empty() ? text : text + " (last value: " + last + ")");
        }
        const Seconds poll = std::chrono::milliseconds(10);
        sleep(left < poll ? left : poll);
    }
}

} // namespace internal
} // namespace rtf

#endif
