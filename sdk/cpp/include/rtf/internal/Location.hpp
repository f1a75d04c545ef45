// SPDX-License-Identifier: Apache-2.0
// A location in a plug-in's source: that of a call.
#ifndef RTF_INTERNAL_LOCATION_HPP
#define RTF_INTERNAL_LOCATION_HPP

namespace rtf {

struct Location
{
    const char *file;
    unsigned line;

    // As a default argument, this is the caller's location, like C++20's
    // std::source_location.
    static constexpr Location current(const char *file = __builtin_FILE(),
                                      unsigned line = __builtin_LINE())
    {
        return Location{file, line};
    }
};

} // namespace rtf

#define RTF_HERE (::rtf::Location{__FILE__, static_cast<unsigned>(__LINE__)})

#endif
