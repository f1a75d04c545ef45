// SPDX-License-Identifier: Apache-2.0
// The time that a plug-in follows: the simulator's, if its suite has a clock.
#ifndef RTF_INTERNAL_CLOCK_HPP
#define RTF_INTERNAL_CLOCK_HPP

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <locale>
#include <optional>

namespace rtf {
namespace internal {

using Seconds = std::chrono::duration<double>;

// The file with the time, which the runner names for tests of such a suite; null
// for the wall clock.
inline const char *clock_file()
{
    const char *path = std::getenv("RTF_CLOCK");
    return path != nullptr && *path != '\0' ? path : nullptr;
}

// What the clock shows; nothing while it is being written.
inline std::optional<Seconds> shown()
{
    const char *path = clock_file();
    if (path == nullptr) {
        return std::chrono::steady_clock::now().time_since_epoch();
    }
    std::ifstream file(path);
    file.imbue(std::locale::classic());
    double seconds = 0.0;
    if (file >> seconds && file.get() == '\n') {
        return Seconds(seconds);
    }
    return std::nullopt;
}

inline Seconds now()
{
    static std::atomic<double> latest{0.0};
    if (const std::optional<Seconds> time = shown()) {
        latest = time->count();
    }
    return Seconds(latest);
}

// Measures how far the time goes on. What it jumps back is no time.
class Stopwatch
{
public:
    Seconds passed()
    {
        if (const std::optional<Seconds> time = shown()) {
            if (before_ && *time > *before_) {
                passed_ += *time - *before_;
            }
            before_ = time;
        }
        return passed_;
    }

private:
    std::optional<Seconds> before_ = shown();
    Seconds passed_{0.0};
};

} // namespace internal
} // namespace rtf

#endif
