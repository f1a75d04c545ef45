// SPDX-License-Identifier: Apache-2.0
// Sends measurements, samples, files and texts of a program to rtf: of tests that were
// written with GoogleTest, Catch2, doctest, CppUnit or another framework. They belong to the
// case that runs at that time. C++11; needs no library.
//
//     TEST(Arm, Moves)
//     {
//         EXPECT_TRUE(rtf::measure("settling time", arm.move(1.2), "s", 0, 0.8));
//     }
//
// If rtf did not start the program, the functions only check limits. They can be called from
// any thread, and wait until rtf has processed the call. They do not throw. In a plug-in, use
// the members of rtf::TestCase.
#ifndef RTF_SESSION_HPP
#define RTF_SESSION_HPP

#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <rtf/internal/SessionChannel.hpp>
#include <rtf/internal/SessionReports.hpp>

namespace rtf {

// A time in seconds and a value.
using SamplePoint = std::pair<double, double>;

// Whether rtf runs this program.
inline bool is_running_in_rtf() noexcept
{
    return internal::session::is_open();
}

// Records a number, and returns whether it is within its limits. If it is not, the case
// fails and continues. A value that is not finite is always outside.
inline bool measure(const std::string &name, double value, const std::string &unit = "",
                    double low = internal::session::no_low,
                    double high = internal::session::no_high,
                    Location here = Location::current()) noexcept
{
    return internal::session::measure({name, unit, low, high, here}, value);
}

// Records a sample of a signal: all samples of a case with the same name. Returns whether it
// is within its limits, as measure() does. The time is in seconds since the program was
// started.
inline bool sample(const std::string &name, double value, const std::string &unit = "",
                   double low = internal::session::no_low, double high = internal::session::no_high,
                   Location here = Location::current()) noexcept
{
    const double now = internal::session::Channel::instance().seconds();
    return internal::session::sample({name, unit, low, high, here}, {SamplePoint(now, value)});
}

// Records samples with their times, in order. One call with many samples is faster than many
// calls.
inline bool sample(const std::string &name, const std::vector<SamplePoint> &points,
                   const std::string &unit = "", double low = internal::session::no_low,
                   double high = internal::session::no_high,
                   Location here = Location::current()) noexcept
{
    return internal::session::sample({name, unit, low, high, here}, points);
}

// Adds a copy of a file to the results, by default under its own name. The file may be
// deleted afterwards. A file that cannot be attached is an error of the case; the function
// then returns false.
inline bool attach(const std::string &path, const std::string &name = "",
                   const std::string &media_type = "", Location here = Location::current()) noexcept
{
    return internal::session::attach(path, name, media_type, here);
}

// Adds a text to the results.
inline void report(const std::string &text, Location here = Location::current()) noexcept
{
    internal::session::message("report", text, here);
}

// A value that a fixture provided, as text: fixture_value("simulator.port"). Without rtf, it
// is `otherwise`. If rtf runs the program, an unknown name is an error of the case.
inline std::string fixture_value(const std::string &name, const std::string &otherwise = "",
                                 Location here = Location::current()) noexcept
{
    return internal::session::fixture_value(name, otherwise, here);
}

} // namespace rtf

#endif
