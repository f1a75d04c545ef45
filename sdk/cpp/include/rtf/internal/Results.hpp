// SPDX-License-Identifier: Apache-2.0
// Measurements and attached files.
#ifndef RTF_INTERNAL_RESULTS_HPP
#define RTF_INTERNAL_RESULTS_HPP

#include <climits>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <rtf/internal/Message.hpp>

namespace rtf {
namespace internal {

struct Measurement
{
    std::string_view name;
    double value;
    std::string_view unit;
    std::optional<double> low;
    std::optional<double> high;
};

inline void check_limits(Location here, const Measurement &measured)
{
    for (const std::optional<double> &limit : {measured.low, measured.high}) {
        if (limit && std::isnan(*limit)) {
            error(here, "a limit of " + std::string(measured.name) + " is not a number");
        }
    }
}

// An `rtf_measurement` or `rtf_sample`. It refers to `measured`, which must outlive it.
template <class Message>
Message to_message(Location here, const Measurement &measured)
{
    auto message = message_at<Message>(here);
    message.name = to_text(measured.name);
    message.value = measured.value;
    message.unit = to_text(measured.unit);
    message.low = measured.low ? &*measured.low : nullptr;
    message.high = measured.high ? &*measured.high : nullptr;
    return message;
}

inline bool measure(Location here, const Measurement &measured)
{
    check_limits(here, measured);
    const auto message = to_message<rtf_measurement>(here, measured);
    return host().measure(host().context, &message) != 0;
}

// The absolute path of a file, or an error of the test.
inline std::unique_ptr<char, void (*)(void *)> existing_file(Location here,
                                                             const std::string &given)
{
    std::unique_ptr<char, void (*)(void *)> full(realpath(given.c_str(), nullptr), std::free);
    if (!full) {
        error(here, "there is no file `" + given + "` to attach");
    }
    return full;
}

inline void attach(Location here, std::string_view path, std::string_view name,
                   std::string_view media_type)
{
    const std::string given(path);
    const auto full = existing_file(here, given);
    const std::string own_name = given.substr(given.find_last_of('/') + 1);
    rtf_attachment attachment;
    attachment.size = sizeof attachment;
    attachment.path = to_text(full.get());
    attachment.name = to_text(name.empty() ? std::string_view(own_name) : name);
    attachment.media_type = to_text(media_type);
    host().attach(host().context, &attachment);
}

} // namespace internal
} // namespace rtf

#endif
