// SPDX-License-Identifier: Apache-2.0
// What a test, or a fixture in its testFinished, keeps with the result.
#ifndef RTF_KEEPER_HPP
#define RTF_KEEPER_HPP

#include <optional>
#include <string_view>

#include <rtf/Plugin.hpp>
#include <rtf/internal/Keep.hpp>

namespace rtf {

class Keeper : public Plugin
{
protected:
    // Keeps a number with the result. Outside its limits it is a failure; the
    // test goes on.
    bool measure(std::string_view name, double value, std::string_view unit = "",
                 std::optional<double> low = std::nullopt,
                 std::optional<double> high = std::nullopt,
                 Location here = Location::current()) const
    {
        return internal::measure(here, internal::Measurement{name, value, unit, low, high});
    }

    // Keeps a copy of a file with the result. The file may go afterwards.
    void attach(std::string_view path, std::string_view name = "", std::string_view media_type = "",
                Location here = Location::current()) const
    {
        internal::attach(here, path, name, media_type);
    }
};

} // namespace rtf

#endif
