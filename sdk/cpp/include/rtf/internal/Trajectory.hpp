// SPDX-License-Identifier: Apache-2.0
// Checks of signals against stored trajectories.
#ifndef RTF_INTERNAL_TRAJECTORY_HPP
#define RTF_INTERNAL_TRAJECTORY_HPP

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
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
    const rtf_host &table = host();
    if (table.size < offsetof(rtf_host, check_trajectory) + sizeof table.check_trajectory) {
        error(here, "this rtf is too old for trajectories: its plug-in interface is 1." +
                        std::to_string(table.abi_minor));
    }
    const double seconds = band ? band->count() : 0;
    rtf_trajectory check;
    check.size = sizeof check;
    check.name = to_text(name);
    check.reference = to_text(reference);
    check.tolerance = tolerance;
    check.band = band ? &seconds : nullptr;
    check.file = here.file;
    check.line = here.line;
    check.align = static_cast<std::int32_t>(align);
    table.check_trajectory(table.context, &check);
}

} // namespace internal
} // namespace rtf

#endif
