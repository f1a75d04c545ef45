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
    const rtf_host &table = host();
    if (table.size < offsetof(rtf_host, check_picture) + sizeof table.check_picture) {
        error(here, "this rtf is too old for pictures: its plug-in interface is 1." +
                        std::to_string(table.abi_minor));
    }
    const auto full = existing_file(here, std::string(picture));
    rtf_picture check;
    check.size = sizeof check;
    check.name = to_text(name);
    check.picture = to_text(full.get());
    check.reference = to_text(reference);
    check.tolerance = tolerance;
    check.file = here.file;
    check.line = here.line;
    table.check_picture(table.context, &check);
}

} // namespace rtf::internal

#endif
