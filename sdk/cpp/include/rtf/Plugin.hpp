// SPDX-License-Identifier: Apache-2.0
// The base class of tests and fixtures.
#ifndef RTF_PLUGIN_HPP
#define RTF_PLUGIN_HPP

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <rtf/Assertions.hpp>
#include <rtf/internal/Results.hpp>
#include <rtf/internal/Values.hpp>

namespace rtf {

// All functions may be called from any thread. Those that end a step (a failed
// assertion, a stop request) throw an exception, and must be called on the thread that
// runs the step.
class Plugin
{
public:
    Plugin() = default;
    Plugin(const Plugin &) = delete;
    Plugin &operator=(const Plugin &) = delete;
    virtual ~Plugin() = default;

    // Called first, with arguments as main() gets them: argv[0] is the plug-in's
    // name in the suite. False: the set-up failed.
    virtual bool setup([[maybe_unused]] int argc, [[maybe_unused]] char **argv) { return true; }

    // Called last, in any case.
    virtual void tearDown() {}

protected:
    void report(std::string_view text, Location here = Location::current()) const
    {
        internal::report(here, text);
    }

    // The time since an arbitrary moment, by the suite's clock.
    std::chrono::duration<double> now() const { return internal::now(); }

    // Sleeps by the suite's clock. A stop request ends the step.
    void sleep(std::chrono::duration<double> duration) const { internal::sleep(duration); }

    // Waits until condition() is true, polling every 10 ms. After the timeout, the
    // assertion fails with `what` and the last value.
    template <class Condition>
    bool wait_until(Condition &&condition, std::chrono::duration<double> timeout,
                    std::string_view what, Location here = Location::current()) const
    {
        return internal::wait_until(here, std::forward<Condition>(condition), timeout, what);
    }

    // Whether the plug-in was asked to stop; long loops should poll this.
    bool interrupted() const { return internal::interrupted(); }

    // The plug-in's name in the suite.
    std::string name() const { return text(internal::host().name); }

    // Its parameter string in the suite.
    std::string param() const { return text(internal::host().param); }

    // The suite's environment string.
    std::string environment() const { return text(internal::host().environment); }

    // The present repetition, from 1.
    unsigned repetition() const { return internal::host().repetition(internal::host().context); }

    // A value that a fixture provided, as text: fixtureValue("simulator.port"). An unknown
    // name is an error. A fixture sees the values of the fixtures that it depends on.
    std::string fixtureValue(std::string_view name, Location here = Location::current()) const
    {
        return internal::fixture_value(here, name);
    }

    // Records a number. Outside its limits it is a failure; the step continues. A fixture
    // measures in its testFinished.
    bool measure(std::string_view name, double value, std::string_view unit = "",
                 std::optional<double> low = std::nullopt,
                 std::optional<double> high = std::nullopt,
                 Location here = Location::current()) const
    {
        return internal::measure(here, internal::Measurement{name, value, unit, low, high});
    }

    // Adds a copy of a file to the results. The file may be deleted afterwards.
    void attach(std::string_view path, std::string_view name = "", std::string_view media_type = "",
                Location here = Location::current()) const
    {
        internal::attach(here, path, name, media_type);
    }

private:
    static std::string text(rtf_text (*get)(void *))
    {
        return internal::from_text(get(internal::host().context));
    }
};

} // namespace rtf

#endif
