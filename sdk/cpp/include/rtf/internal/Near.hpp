// SPDX-License-Identifier: Apache-2.0
// Near equality of scalars, vectors and angles.
#ifndef RTF_INTERNAL_NEAR_HPP
#define RTF_INTERNAL_NEAR_HPP

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <rtf/internal/Message.hpp>
#include <rtf/internal/Number.hpp>

namespace rtf {
namespace internal {

enum class Measure { plain, angle };

// Appends a number, or the numbers of a range, row after row.
template <class T>
void flatten(const T &thing, std::vector<double> &numbers)
{
    if constexpr (std::is_arithmetic_v<T>) {
        numbers.push_back(static_cast<double>(thing));
    } else {
        for (const auto &element : thing) {
            flatten(element, numbers);
        }
    }
}

// Actual and expected numbers.
struct Numbers
{
    std::vector<double> got;
    std::vector<double> expected;
    double tolerance;
    Measure measure;
    bool scalar;

    double difference(std::size_t index) const
    {
        const double plain = got[index] - expected[index];
        const double full_turn = 6.283185307179586476925286766559;
        return std::fabs(measure == Measure::angle ? std::remainder(plain, full_turn) : plain);
    }

    // The index with the largest difference; non-finite numbers come first.
    std::size_t worst() const
    {
        std::size_t worst = 0;
        for (std::size_t index = 0; index < got.size(); ++index) {
            if (!std::isfinite(got[index]) || !std::isfinite(expected[index])) {
                return index;
            }
            if (difference(index) > difference(worst)) {
                worst = index;
            }
        }
        return worst;
    }

    // Describes the problem; empty if both are near.
    std::string problem() const
    {
        if (got.size() != expected.size()) {
            return "got " + std::to_string(got.size()) + " values, expected " +
                   std::to_string(expected.size());
        }
        if (got.empty()) {
            return std::string();
        }
        const std::size_t index = worst();
        const bool finite = std::isfinite(got[index]) && std::isfinite(expected[index]);
        if (finite && difference(index) <= tolerance) {
            return std::string();
        }
        std::string text = "got " + number(got[index]) + ", expected " + number(expected[index]) +
                           " ± " + number(tolerance);
        if (finite) {
            text += " (off by " + number(difference(index)) + ")";
        }
        return scalar ? text : text + " at index " + std::to_string(index);
    }
};

// Reports the comparison. With too many numbers for a line of the host protocol, only
// the text.
inline bool report_comparison(Location here, const Numbers &numbers, std::string_view what)
{
    constexpr std::size_t most = 100000;
    rtf_comparison comparison;
    comparison.size = sizeof comparison;
    comparison.expected = numbers.expected.data();
    comparison.expected_count = numbers.expected.size();
    comparison.got = numbers.got.data();
    comparison.got_count = numbers.got.size();
    comparison.tolerance = numbers.tolerance;
    const bool has_worst =
        !numbers.scalar && !numbers.got.empty() && numbers.got.size() == numbers.expected.size();
    comparison.worst = has_worst ? static_cast<int64_t>(numbers.worst()) : -1;
    const bool few = numbers.got.size() + numbers.expected.size() <= most;
    const std::string problem = numbers.problem();
    std::string text(what);
    if (!problem.empty()) {
        text += ": " + problem;
    }
    send(problem.empty() ? RTF_MESSAGE_CHECK : RTF_MESSAGE_FAILURE, text, here,
         few ? &comparison : nullptr);
    return problem.empty();
}

template <class Got, class Expected>
bool check_near(Location here, Measure measure, const Got &got, const Expected &expected,
                double tolerance, std::string_view what)
{
    if (!(std::isfinite(tolerance) && tolerance >= 0)) {
        error(here, "the tolerance " + number(tolerance) + " is not a finite number from 0");
    }
    Numbers numbers{{}, {}, tolerance, measure, false};
    numbers.scalar = std::is_arithmetic_v<Got> && std::is_arithmetic_v<Expected>;
    flatten(got, numbers.got);
    flatten(expected, numbers.expected);
    return report_comparison(here, numbers, what);
}

template <class Got>
bool check_near(Location here, Measure measure, const Got &got,
                std::initializer_list<double> expected, double tolerance, std::string_view what)
{
    return check_near<Got, std::initializer_list<double>>(here, measure, got, expected, tolerance,
                                                          what);
}

template <class... Arguments>
void require_near(Location here, Measure measure, Arguments &&...arguments)
{
    if (!check_near(here, measure, std::forward<Arguments>(arguments)...)) {
        throw Stop();
    }
}

template <class Got>
void require_near(Location here, Measure measure, const Got &got,
                  std::initializer_list<double> expected, double tolerance, std::string_view what)
{
    if (!check_near(here, measure, got, expected, tolerance, what)) {
        throw Stop();
    }
}

} // namespace internal
} // namespace rtf

#endif
