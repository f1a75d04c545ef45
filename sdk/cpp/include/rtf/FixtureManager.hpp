// SPDX-License-Identifier: Apache-2.0
// A fixture: derive from rtf::FixtureManager, and write RTF_PLUGIN(Class) once.
#ifndef RTF_FIXTUREMANAGER_HPP
#define RTF_FIXTUREMANAGER_HPP

#include <string>
#include <string_view>

#include <rtf/Declare.hpp>
#include <rtf/Plugin.hpp>
#include <rtf/internal/Values.hpp>

namespace rtf {

// Reports a collapse to the runner, from any thread.
class FixtureEvents
{
public:
    // The runner stops the running test and sets up the fixtures again.
    void fixtureCollapsed(std::string_view reason) const
    {
        const rtf_host &host = internal::host();
        host.collapsed(host.context, internal::to_text(reason));
    }
};

// An attempt of a test.
struct Test
{
    unsigned id;         // its number in the run
    std::string name;    // its name in the suite
    unsigned repetition; // from 1
    unsigned attempt;    // at this repetition, from 1
};

class FixtureManager : public Plugin
{
public:
    // Whether the fixture works. Called before each test, and as often as the suite
    // says.
    virtual bool check() { return true; }

    // Called before a test starts. False: the fixture collapsed.
    virtual bool testStarted([[maybe_unused]] const Test &test) { return true; }

    // Called after a test with its verdict: "passed", "failed", "error", "crashed", ...
    // Reports, measurements and attachments of this function belong to that test.
    virtual bool testFinished([[maybe_unused]] const Test &test,
                              [[maybe_unused]] std::string_view verdict,
                              [[maybe_unused]] std::string_view reason)
    {
        return true;
    }

    const FixtureEvents *getDispatcher() const { return &events_; }

protected:
    // Provides a value for tests, hooks and dependent fixtures, in setup: a text, a number, a
    // bool, or rtf::Json{"[1, 2]"}.
    template <class T>
    void provide(std::string_view name, const T &value, Location here = Location::current()) const
    {
        internal::provide_value(here, name, value);
    }

    // The same as getDispatcher()->fixtureCollapsed(reason).
    void collapsed(std::string_view reason) const { events_.fixtureCollapsed(reason); }

private:
    FixtureEvents events_;
};

} // namespace rtf

#endif
