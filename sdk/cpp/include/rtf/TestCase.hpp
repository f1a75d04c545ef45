// SPDX-License-Identifier: Apache-2.0
// A test: derive from rtf::TestCase, and write RTF_PLUGIN(Class) once.
#ifndef RTF_TESTCASE_HPP
#define RTF_TESTCASE_HPP

#include <chrono>
#include <optional>
#include <string_view>
#include <utility>

#include <rtf/Declare.hpp>
#include <rtf/Plugin.hpp>
#include <rtf/internal/Sampling.hpp>

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
};

} // namespace rtf

#endif
