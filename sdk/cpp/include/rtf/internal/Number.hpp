// SPDX-License-Identifier: Apache-2.0
// Formats values in messages: the same in all SDKs (see conformance/texts.json).
#ifndef RTF_INTERNAL_NUMBER_HPP
#define RTF_INTERNAL_NUMBER_HPP

#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>

namespace rtf {
namespace internal {

inline std::string number(double value)
{
    if (std::isnan(value)) {
        return "nan"; // C may print its sign
    }
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.6g", value);
    return digits;
}

// The last value of a condition; empty if its type has no text.
template <class T>
std::string last_value(const T &value)
{
    if constexpr (std::is_same_v<T, bool>) {
        return value ? "true" : "false";
    } else if constexpr (std::is_integral_v<T>) {
        return std::to_string(value);
    } else if constexpr (std::is_arithmetic_v<T>) {
        return number(static_cast<double>(value));
    } else if constexpr (std::is_convertible_v<const T &, std::string_view>) {
        return std::string(std::string_view(value));
    } else {
        return std::string();
    }
}

} // namespace internal
} // namespace rtf

#endif
