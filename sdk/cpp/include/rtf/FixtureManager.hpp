// SPDX-License-Identifier: Apache-2.0
// A fixture: derive from rtf::FixtureManager, and write RTF_PLUGIN(Class) once.
#ifndef RTF_FIXTUREMANAGER_HPP
#define RTF_FIXTUREMANAGER_HPP

#include <string_view>

#include <rtf/Declare.hpp>
#include <rtf/Plugin.hpp>

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

class FixtureManager : public Plugin
{
public:
    // Whether the fixture is well. Called before each test, and as often as the
    // suite says.
    virtual bool check() { return true; }

    const FixtureEvents *getDispatcher() const { return &events_; }

protected:
    // The same as getDispatcher()->fixtureCollapsed(reason).
    void collapsed(std::string_view reason) const { events_.fixtureCollapsed(reason); }

private:
    FixtureEvents events_;
};

} // namespace rtf

#endif
