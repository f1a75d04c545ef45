// SPDX-License-Identifier: Apache-2.0
// Checks and assertions for tests and fixtures, with file and line, for any function of
// a plug-in. A text is anything that converts to std::string_view. A check returns its
// result as a bool, and the step continues; a failed REQUIRE, FAIL and ERROR end the step, or
// the innermost case.
#ifndef RTF_ASSERTIONS_HPP
#define RTF_ASSERTIONS_HPP

#include <rtf/internal/Cases.hpp>
#include <rtf/internal/Message.hpp>
#include <rtf/internal/Near.hpp>
#include <rtf/internal/Wait.hpp>

// RTF_REPORT(text): information only.
#define RTF_REPORT(...) ::rtf::internal::report(RTF_HERE, __VA_ARGS__)

// RTF_CHECK(condition, text)
#define RTF_CHECK(...) ::rtf::internal::check(RTF_HERE, __VA_ARGS__)

// RTF_REQUIRE(condition, text)
#define RTF_REQUIRE(...) ::rtf::internal::require(RTF_HERE, __VA_ARGS__)

// RTF_REQUIRE_CRITICAL(condition, text): if it does not hold, it is unsafe to continue,
// and the rest of the suite is skipped.
#define RTF_REQUIRE_CRITICAL(...) ::rtf::internal::require_critical(RTF_HERE, __VA_ARGS__)

// RTF_FAIL(text): the robot is wrong.
#define RTF_FAIL(...) ::rtf::internal::fail(RTF_HERE, __VA_ARGS__)

// RTF_ERROR(text): the bench is wrong.
#define RTF_ERROR(...) ::rtf::internal::error(RTF_HERE, __VA_ARGS__)

// RTF_SKIP(reason): ends the innermost case of this thread, or without one the test, as
// skipped.
#define RTF_SKIP(...) ::rtf::internal::skip(RTF_HERE, __VA_ARGS__)

// RTF_CASE("joint 3", {{"joint", 3}}) { ... }; is a named result of its test. The body is a
// lambda that captures by reference: `return` leaves the case. The parameters can be omitted.
#define RTF_CASE(...) ::rtf::internal::Case(RTF_HERE, __VA_ARGS__) + [&]

// RTF_CHECK_NEAR(got, expected, tolerance, what): numbers, or ranges of numbers
// or of ranges; expected may be a list in braces.
#define RTF_CHECK_NEAR(...)                                                                        \
    ::rtf::internal::check_near(RTF_HERE, ::rtf::internal::Measure::plain, __VA_ARGS__)
#define RTF_REQUIRE_NEAR(...)                                                                      \
    ::rtf::internal::require_near(RTF_HERE, ::rtf::internal::Measure::plain, __VA_ARGS__)

// The same for angles in radians, modulo a full turn.
#define RTF_CHECK_ANGLE_NEAR(...)                                                                  \
    ::rtf::internal::check_near(RTF_HERE, ::rtf::internal::Measure::angle, __VA_ARGS__)
#define RTF_REQUIRE_ANGLE_NEAR(...)                                                                \
    ::rtf::internal::require_near(RTF_HERE, ::rtf::internal::Measure::angle, __VA_ARGS__)

// RTF_REQUIRE_UNTIL(condition, timeout, what): waits until the expression is
// true, polling every 10 ms.
#define RTF_REQUIRE_UNTIL(condition, timeout, what)                                                \
    ::rtf::internal::wait_until(                                                                   \
        RTF_HERE, [&] { return (condition); }, timeout, what)

#endif
