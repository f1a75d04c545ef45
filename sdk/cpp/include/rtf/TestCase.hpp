// SPDX-License-Identifier: Apache-2.0
// A test: derive from rtf::TestCase, and write RTF_PLUGIN(Class) once.
#ifndef RTF_TESTCASE_HPP
#define RTF_TESTCASE_HPP

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <rtf/Declare.hpp>
#include <rtf/Plugin.hpp>
#include <rtf/internal/Cases.hpp>
#include <rtf/internal/Faults.hpp>
#include <rtf/internal/Monitor.hpp>
#include <rtf/internal/Picture.hpp>
#include <rtf/internal/Questions.hpp>
#include <rtf/internal/Sampling.hpp>
#include <rtf/internal/Trajectory.hpp>
#include <rtf/internal/Values.hpp>

namespace rtf {

class TestCase : public Plugin
{
public:
    // Runs the test. Called if setup succeeded.
    virtual void run() = 0;

protected:
    // Takes a sample of a signal. Outside its limits it is a failure; the test
    // continues. The time is since the set-up began; the default is the current time.
    bool sample(std::string_view name, double value, std::string_view unit = "",
                std::optional<double> low = std::nullopt, std::optional<double> high = std::nullopt,
                std::optional<std::chrono::duration<double>> time = std::nullopt,
                Location here = Location::current()) const
    {
        return internal::sample(here, internal::Measurement{name, value, unit, low, high}, time);
    }

    // Checks that a signal, as sampled so far, stays within `tolerance` of a stored trajectory: a
    // file below the directory of the suite, which `rtf golden accept` writes. With Align::dtw,
    // times may differ by `band`. The runner compares: the test continues, a deviation is a
    // failure.
    void check_trajectory(std::string_view name, std::string_view reference, double tolerance,
                          Align align = Align::time,
                          std::optional<std::chrono::duration<double>> band = std::nullopt,
                          Location here = Location::current()) const
    {
        internal::check_trajectory(here, name, reference, tolerance, align, band);
    }

    // Checks that a picture, a PNG or JPEG file, differs by at most `tolerance` (1 minus the
    // structural similarity) from a stored one: a file below the directory of the suite, which
    // `rtf golden accept` writes. The runner compares a copy: the test continues, a difference is
    // a failure.
    void check_picture(std::string_view name, std::string_view picture, std::string_view reference,
                       double tolerance, Location here = Location::current()) const
    {
        internal::check_picture(here, name, picture, reference, tolerance);
    }

    // Judges the rest of the test by a formula over the signals of the suite. The default name
    // is the formula.
    void monitor(std::string_view formula, std::string_view name = "",
                 Severity severity = Severity::fail, Location here = Location::current()) const
    {
        internal::monitor(here, formula, name, severity);
    }

    // Samples the result of read() at `rate` Hz, and returns whether all are within
    // the limits. A slow read() skips samples.
    template <class Read>
    bool
    sample_for(std::string_view name, std::chrono::duration<double> duration, double rate,
               Read &&read, std::string_view unit = "", std::optional<double> low = std::nullopt,
               std::optional<double> high = std::nullopt, Location here = Location::current()) const
    {
        const internal::Measurement signal{name, 0, unit, low, high};
        return internal::sample_for(here, signal, duration, rate, std::forward<Read>(read));
    }

    // Ends the innermost case of this thread, or without one the test, as skipped.
    [[noreturn]] void skip(std::string_view reason, Location here = Location::current()) const
    {
        internal::skip(here, reason);
    }

    // Announces top-level cases: reports show which of them did not run, and a test that
    // would pass without having run them all is an error.
    void plan_cases(const std::vector<std::string> &names,
                    Location here = Location::current()) const
    {
        internal::plan_cases(here, names);
    }

    // Asks an operator, on the console, the page or the API, and returns the answer: one of
    // `choices`, or without them any line of text. If no operator answers in this time, or none
    // can, it is the default answer; without one, this is an error. The picture is a PNG or JPEG
    // file. The time limit of the test is paused meanwhile.
    std::string ask(std::string_view question, const std::vector<std::string> &choices = {},
                    std::chrono::duration<double> timeout = internal::kAnswerTime,
                    std::string_view default_answer = "", std::string_view picture = "",
                    Location here = Location::current()) const
    {
        return internal::ask(
            here, internal::Question{question, choices, timeout, default_answer, picture});
    }

    // Gives an operator an instruction, and waits until it is done. The answers are `done` and
    // `cannot`, which is an error; the default answer is one of them.
    void instruct(std::string_view text, std::string_view picture = "",
                  std::chrono::duration<double> timeout = internal::kAnswerTime,
                  std::string_view default_answer = "", Location here = Location::current()) const
    {
        internal::instruct(here, text, picture, timeout, default_answer);
    }

    // Injects a fault of the suite, and returns when it has begun.
    Fault fault(std::string_view name, Location here = Location::current()) const
    {
        return Fault(std::string(name), here);
    }

    // The test's value of a matrix. An unknown name is an error.
    std::string parameter(std::string_view name, Location here = Location::current()) const
    {
        return internal::parameter(here, name);
    }

    // All values of the matrix.
    std::map<std::string, std::string> parameters(Location here = Location::current()) const
    {
        return internal::parameters(here);
    }
};

} // namespace rtf

#endif
