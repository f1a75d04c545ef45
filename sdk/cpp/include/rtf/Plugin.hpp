// SPDX-License-Identifier: Apache-2.0
// What tests and fixtures have in common.
#ifndef RTF_PLUGIN_HPP
#define RTF_PLUGIN_HPP

#include <chrono>
#include <string>
#include <string_view>
#include <utility>

#include <rtf/Assertions.hpp>

namespace rtf {

// All functions may be called from any thread. Those that end a step (a failed
// assertion, a request to stop) do so by an exception and belong on the thread
// that runs the step.
class Plugin
{
public:
    Plugin() = default;
    Plugin(const Plugin &) = delete;
    Plugin &operator=(const Plugin &) = delete;
    virtual ~Plugin() = default;

    // Called first, with arguments as main() gets them: argv[0] is the plug-in's
    // name in the suite. False: the set-up failed.
    virtual bool setup(int argc, char **argv)
    {
        static_cast<void>(argc);
        static_cast<void>(argv);
        return true;
    }

    // Called last, whatever happened before.
    virtual void tearDown() {}

protected:
    void report(std::string_view text, Location here = Location::current()) const
    {
        internal::report(here, text);
    }

    // The time since a moment that does not matter, by the clock that the suite has.
    std::chrono::duration<double> now() const { return internal::now(); }

    // Sleeps, in a suite with a clock by that one; ends the step when the plug-in is asked to stop.
    void sleep(std::chrono::duration<double> duration) const { internal::sleep(duration); }

    // Waits until condition() is true, asking every 10 ms. When the time is over
    // this is a failed assertion that tells what was waited for and the last value.
    template <class Condition>
    bool wait_until(Condition &&condition, std::chrono::duration<double> timeout,
                    std::string_view what, Location here = Location::current()) const
    {
        return internal::wait_until(here, std::forward<Condition>(condition), timeout, what);
    }

    // Whether the plug-in was asked to stop; a loop that runs long should look.
    bool interrupted() const { return internal::interrupted(); }

    // The name under which the suite knows the plug-in.
    std::string name() const { return text(internal::host().name); }

    // Its parameter string in the suite.
    std::string param() const { return text(internal::host().param); }

    // The suite's environment string.
    std::string environment() const { return text(internal::host().environment); }

    // The repetition, from 1.
    unsigned repetition() const { return internal::host().repetition(internal::host().context); }

private:
    static std::string text(rtf_text (*get)(void *))
    {
        return internal::from_text(get(internal::host().context));
    }
};

} // namespace rtf

#endif
