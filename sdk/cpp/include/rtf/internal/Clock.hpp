// SPDX-License-Identifier: Apache-2.0
// The time for a plug-in: the simulator's, if its suite has a clock.
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

// The file with the simulated time; null for the wall clock.
inline const char *clock_file()
{
    const char *path = std::getenv("RTF_CLOCK");
    return path != nullptr && *path != '\0' ? path : nullptr;
}

// The clock's time; nothing while the file is being written.
inline std::optional<Seconds> read_clock()
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
    if (const std::optional<Seconds> time = read_clock()) {
        latest = time->count();
    }
    return Seconds(latest);
}

// Measures the elapsed time, without jumps back.
class Stopwatch
{
public:
    Seconds passed()
    {
        if (const std::optional<Seconds> time = read_clock()) {
            if (before_ && *time > *before_) {
                passed_ += *time - *before_;
            }
            before_ = time;
        }
        return passed_;
    }

private:
    std::optional<Seconds> before_ = read_clock();
    Seconds passed_{0.0};
};

} // namespace internal
} // namespace rtf

#endif
