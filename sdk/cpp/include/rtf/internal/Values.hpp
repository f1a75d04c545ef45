// SPDX-License-Identifier: Apache-2.0
// A test's values of a matrix, and the values of fixtures.
#ifndef RTF_INTERNAL_VALUES_HPP
#define RTF_INTERNAL_VALUES_HPP

#include <cmath>
#include <cstddef>
#include <iomanip>
#include <limits>
#include <locale>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>

#include <rtf/internal/Message.hpp>

namespace rtf {

// A value of a fixture that is neither a text nor a number: rtf::Json{"[1, 2]"}.
struct Json
{
    std::string text;
};

namespace internal {

// Values that the host lends, as an array.
struct NamedValues
{
    const rtf_parameter *first = nullptr;
    std::size_t count = 0;
};

inline NamedValues matrix_values(Location here)
{
    const rtf_host &table = host_since_1_3(here, "cases");
    NamedValues values;
    values.first = table.parameters(table.context, &values.count);
    return values;
}

inline NamedValues fixture_values(Location here)
{
    const rtf_host &table = host_since_1_3(here, "values of fixtures");
    NamedValues values;
    values.first = table.fixture_values(table.context, &values.count);
    return values;
}

// The error for an unknown name: there is no <what> "…"; <known_are> a, b.
inline std::string find_value(Location here, NamedValues values, std::string_view name,
                              std::string_view what, std::string_view known_are)
{
    std::string known;
    for (std::size_t index = 0; index < values.count; ++index) {
        const std::string own = from_text(values.first[index].name);
        if (own == name) {
            return from_text(values.first[index].value);
        }
        known += (index == 0 ? "" : ", ") + own;
    }
    error(here, "there is no " + std::string(what) + " \"" + std::string(name) + "\"; " +
                    std::string(known_are) + " " + (values.count == 0 ? "none" : known));
}

inline std::map<std::string, std::string> parameters(Location here)
{
    const NamedValues values = matrix_values(here);
    std::map<std::string, std::string> all;
    for (std::size_t index = 0; index < values.count; ++index) {
        all.emplace(from_text(values.first[index].name), from_text(values.first[index].value));
    }
    return all;
}

inline std::string parameter(Location here, std::string_view name)
{
    return find_value(here, matrix_values(here), name, "parameter", "this test has");
}

inline std::string fixture_value(Location here, std::string_view name)
{
    return find_value(here, fixture_values(here), name, "fixture value", "there are");
}

// A number in JSON, with all its digits. A plug-in may have set another decimal point.
inline std::string json_number(double value)
{
    std::ostringstream stream;
    stream.imbue(std::locale::classic());
    stream << std::setprecision(std::numeric_limits<double>::max_digits10) << value;
    const std::string digits = stream.str();
    return digits.find_first_of(".e") == std::string::npos ? digits + ".0" : digits;
}

template <class T>
std::string json_value(Location here, std::string_view name, const T &value)
{
    if constexpr (std::is_same_v<T, bool>) {
        return value ? "true" : "false";
    } else if constexpr (std::is_integral_v<T>) {
        return std::to_string(value);
    } else {
        const double number = static_cast<double>(value);
        if (!std::isfinite(number)) {
            error(here, "the value of `" + std::string(name) + "` is not a finite number");
        }
        return json_number(number);
    }
}

inline void provide(Location here, std::string_view name, int32_t kind, std::string_view value)
{
    const rtf_host &table = host_since_1_3(here, "values of fixtures");
    table.provide(table.context, to_text(name), kind, to_text(value));
}

template <class T>
void provide_value(Location here, std::string_view name, const T &value)
{
    if constexpr (std::is_same_v<T, Json>) {
        provide(here, name, RTF_VALUE_JSON, value.text);
    } else if constexpr (std::is_convertible_v<const T &, std::string_view>) {
        provide(here, name, RTF_VALUE_TEXT, value);
    } else {
        static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, char>,
                      "a value is a text, a number, a bool or rtf::Json");
        provide(here, name, RTF_VALUE_JSON, json_value(here, name, value));
    }
}

} // namespace internal
} // namespace rtf

#endif
