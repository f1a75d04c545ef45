// SPDX-License-Identifier: Apache-2.0
// Samples of signals, one by one or at a rate.
#ifndef RTF_INTERNAL_SAMPLING_HPP
#define RTF_INTERNAL_SAMPLING_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

#include <rtf/internal/Results.hpp>
#include <rtf/internal/Wait.hpp>

namespace rtf {
namespace internal {

inline bool sample(Location here, const Measurement &taken, std::optional<Seconds> time)
{
    const rtf_host &table = host_with(offsetof(rtf_host, sample), here, "samples");
    check_limits(here, taken);
    const double at = time ? time->count() : 0;
    if (!std::isfinite(at)) {
        error(here, "the time of a sample of " + std::string(taken.name) + " is not finite");
    }
    auto message = to_message<rtf_sample>(here, taken);
    message.time = time ? &at : nullptr;
    return table.sample(table.context, &message) != 0;
}

template <class Read>
bool sample_for(Location here, Measurement signal, Seconds duration, double rate, Read &&read)
{
    if (!(rate > 0)) {
        error(here, "the rate of " + std::string(signal.name) + " is not above 0 Hz");
    }
    Stopwatch watch;
    bool all_within = true;
    // Each tick has a separate deadline, so that delays do not accumulate.
    for (double tick = 0; tick < duration.count() * rate - 1e-9;
         tick = std::max(tick + 1, std::ceil(watch.passed().count() * rate))) {
        sleep(Seconds(tick / rate) - watch.passed());
        signal.value = static_cast<double>(read());
        all_within = sample(here, signal, std::nullopt) && all_within;
    }
    sleep(duration - watch.passed());
    return all_within;
}

} // namespace internal
} // namespace rtf

#endif
