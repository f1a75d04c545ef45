// SPDX-License-Identifier: Apache-2.0
// Calls of the host about episodes, and hashes of observations.
#ifndef RTF_INTERNAL_EPISODES_HPP
#define RTF_INTERNAL_EPISODES_HPP

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include <rtf/internal/Exceptions.hpp>

namespace rtf {
namespace internal {

inline const rtf_host &host_with_episodes(Location here)
{
    return host_with(offsetof(rtf_host, finish_episode), here, "episodes");
}

inline rtf_slots episode_slots(Location here)
{
    const rtf_host &table = host_with_episodes(here);
    rtf_slots slots{};
    slots.size = sizeof slots;
    if (table.slots(table.context, &slots) != RTF_DONE) {
        error(here, "the test has no `slots` in its suite, so it gets no episodes");
    }
    return slots;
}

// Takes an episode, and returns whether there is one.
inline bool take_episode(Location here, bool wait, rtf_episode &episode)
{
    const rtf_host &table = host_with_episodes(here);
    episode.size = sizeof episode;
    const std::int32_t result = table.take_episode(table.context, wait ? 1 : 0, &episode);
    if (result == RTF_STOPPED) {
        throw Stop{true};
    }
    return result == RTF_DONE;
}

// Enters an episode. The host has reported an error, which ends the step or the case.
inline void enter_episode(Location here, std::uint64_t id)
{
    const rtf_host &table = host_with_episodes(here);
    if (table.enter_episode(table.context, id) != RTF_DONE) {
        throw Stop();
    }
}

inline void leave_episode(std::uint64_t id)
{
    host().leave_episode(host().context, id);
}

inline void finish_episode(Location here, std::uint64_t id, const rtf_episode_end &end)
{
    const rtf_host &table = host_with_episodes(here);
    if (table.finish_episode(table.context, id, &end) != RTF_DONE) {
        throw Stop();
    }
}

// A hash of numbers and texts, for comparing them with each other.
class Hash
{
public:
    // Adds a number, a text, or the elements of a range.
    template <class T>
    void add(const T &thing)
    {
        if constexpr (std::is_arithmetic_v<T>) {
            // Both zeros are the same number.
            const double number = static_cast<double>(thing) + 0.0;
            std::uint64_t bits = 0;
            std::memcpy(&bits, &number, sizeof bits);
            mix(bits);
        } else if constexpr (std::is_convertible_v<const T &, std::string_view>) {
            for (const char letter : std::string_view(thing)) {
                mix(static_cast<unsigned char>(letter));
            }
        } else {
            for (const auto &element : thing) {
                add(element);
            }
        }
    }

    // 16 hexadecimal digits.
    std::string text() const
    {
        char digits[17];
        std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(state_));
        return digits;
    }

private:
    // A step of Vigna's SplitMix64.
    void mix(std::uint64_t bits)
    {
        std::uint64_t mixed = (state_ ^ bits) + 0x9E3779B97F4A7C15U;
        mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9U;
        mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EBU;
        state_ = mixed ^ (mixed >> 31U);
    }

    std::uint64_t state_ = 0;
};

} // namespace internal
} // namespace rtf

#endif
