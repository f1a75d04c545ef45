// SPDX-License-Identifier: Apache-2.0
// A fixture: derive from rtf::FixtureManager, and write RTF_PLUGIN(Class) once.
#ifndef RTF_FIXTUREMANAGER_HPP
#define RTF_FIXTUREMANAGER_HPP

#include <string>
#include <string_view>

#include <rtf/Declare.hpp>
#include <rtf/Keeper.hpp>

namespace rtf {

// Takes the news of a collapse to the runner, from any thread.
class FixtureEvents
{
public:
    // The fixture is not well any more: the running test is stopped, and the
    // fixtures are set up again.
    void fixtureCollapsed(std::string_view reason) const
    {
        const rtf_host &host = internal::host();
        host.collapsed(host.context, internal::to_text(reason));
    }
};

// An attempt of a test, of which a fixture is told.
struct Test
{
    unsigned id;         // its number in the run
    std::string name;    // its name in the suite
    unsigned repetition; // from 1
    unsigned attempt;    // at this repetition, from 1
};

class FixtureManager : public Keeper
{
public:
    // Whether the fixture is well. Called before each test, and as often as the
    // suite says.
    virtual bool check() { return true; }

    // A test is about to begin. False: the fixture collapsed.
    virtual bool testStarted(const Test &test)
    {
        static_cast<void>(test);
        return true;
    }

    // How a test was judged: "passed", "failed", "error", "crashed", ... What is
    // reported, measured and attached here belongs to that test.
    virtual bool testFinished(const Test &test, std::string_view verdict, std::string_view reason)
    {
        static_cast<void>(test);
        static_cast<void>(verdict);
        static_cast<void>(reason);
        return true;
    }

    const FixtureEvents *getDispatcher() const { return &events_; }

protected:
    // The same as getDispatcher()->fixtureCollapsed(reason).
    void collapsed(std::string_view reason) const { events_.fixtureCollapsed(reason); }

private:
    FixtureEvents events_;
};

} // namespace rtf

#endif
