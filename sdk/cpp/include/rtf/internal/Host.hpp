// SPDX-License-Identifier: Apache-2.0
// The host's table of functions for the loaded plug-in.
#ifndef RTF_INTERNAL_HOST_HPP
#define RTF_INTERNAL_HOST_HPP

#include <atomic>
#include <stdexcept>
#include <string>
#include <string_view>

#include <rtf/plugin.h>

namespace rtf {
namespace internal {

// One per process, so that a helper library reports for the plug-in that calls it.
inline std::atomic<const rtf_host *> current_host{nullptr};

inline const rtf_host &host()
{
    const rtf_host *host = current_host.load(std::memory_order_acquire);
    if (host == nullptr) {
        throw std::logic_error("the rtf SDK was used before a plug-in was created");
    }
    return *host;
}

inline rtf_text to_text(std::string_view text)
{
    return rtf_text{text.data(), text.size()};
}

inline std::string from_text(rtf_text text)
{
    return text.length == 0 ? std::string() : std::string(text.data, text.length);
}

} // namespace internal
} // namespace rtf

#endif
