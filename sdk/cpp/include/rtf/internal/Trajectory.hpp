// SPDX-License-Identifier: Apache-2.0
// Checks of signals against stored trajectories.
#ifndef RTF_INTERNAL_TRAJECTORY_HPP
#define RTF_INTERNAL_TRAJECTORY_HPP

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <rtf/internal/Results.hpp>
#include <rtf/internal/Sampling.hpp>

namespace rtf {

// How the times of a signal and of a stored trajectory are aligned.
enum class Align {
    // Both start at their first sample.
    time = RTF_ALIGN_TIME,
    // By dynamic time warping.
    dtw = RTF_ALIGN_DTW,
};

namespace internal {

inline void check_trajectory(Location here, std::string_view name, std::string_view reference,
                             double tolerance, Align align, std::optional<Seconds> band)
{
    const rtf_host &table = host_with(offsetof(rtf_host, check_trajectory), here, "trajectories");
    const double seconds = band ? band->count() : 0;
    auto check = message_at<rtf_trajectory>(here);
    check.name = to_text(name);
    check.reference = to_text(reference);
    check.tolerance = tolerance;
    check.band = band ? &seconds : nullptr;
    check.align = static_cast<std::int32_t>(align);
    table.check_trajectory(table.context, &check);
}

} // namespace internal
} // namespace rtf

#endif
