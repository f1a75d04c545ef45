// SPDX-License-Identifier: Apache-2.0
// Checks of pictures against stored ones.
#ifndef RTF_INTERNAL_PICTURE_HPP
#define RTF_INTERNAL_PICTURE_HPP

#include <cstddef>
#include <string>
#include <string_view>

#include <rtf/internal/Results.hpp>

namespace rtf::internal {

inline void check_picture(Location here, std::string_view name, std::string_view picture,
                          std::string_view reference, double tolerance)
{
    const rtf_host &table = host_with(offsetof(rtf_host, check_picture), here, "pictures");
    const auto full = existing_file(here, std::string(picture));
    auto check = message_at<rtf_picture>(here);
    check.name = to_text(name);
    check.picture = to_text(full.get());
    check.reference = to_text(reference);
    check.tolerance = tolerance;
    table.check_picture(table.context, &check);
}

} // namespace rtf::internal

#endif
