// SPDX-License-Identifier: Apache-2.0
// Sleeping and waiting; a stop request ends both.
#ifndef RTF_INTERNAL_WAIT_HPP
#define RTF_INTERNAL_WAIT_HPP

#include <chrono>
#include <string>
#include <string_view>

#include <rtf/internal/Clock.hpp>
#include <rtf/internal/Message.hpp>
#include <rtf/internal/Number.hpp>

namespace rtf {
namespace internal {

inline bool interrupted()
{
    return host().interrupted(host().context) != 0;
}

// The polling interval for conditions and simulators' clocks.
constexpr Seconds kPoll = std::chrono::milliseconds(10);

// Sleeps by the wall clock.
inline void pause(Seconds duration)
{
    if (host().wait(host().context, duration.count()) != 0) {
        throw Stop{true};
    }
}

inline void sleep(Seconds duration)
{
    if (clock_file() == nullptr) {
        return pause(duration);
    }
    Stopwatch watch;
    for (Seconds left = duration; left.count() > 0; left = duration - watch.passed()) {
        pause(left < kPoll ? left : kPoll);
    }
    pause(Seconds(0));
}

// Polls every 10 ms. After the timeout, the assertion fails.
template <class Condition>
bool wait_until(Location here, Condition &&condition, Seconds timeout, std::string_view what)
{
    Stopwatch watch;
    for (;;) {
        const auto value = condition();
        if (static_cast<bool>(value)) {
            return true;
        }
        const Seconds left = timeout - watch.passed();
        if (!(left.count() > 0)) {
            std::string text(what);
            text += ": not within " + number(timeout.count()) + " s";
            text += clock_file() != nullptr ? " of simulated time" : "";
            const std::string last = last_value(value);
            fail(here, last.empty() ? text : text + " (last value: " + last + ")");
        }
        pause(left < kPoll ? left : kPoll);
    }
}

} // namespace internal
} // namespace rtf

#endif
