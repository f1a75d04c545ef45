// A fixture as in the paper: one header, PREPARE macro before the class, and private
// inheritance from a middleware's manager.
#include <FixtureManager.h>

#include <string>

PREPARE_FIXTURE_PLUGIN(PaperRig)

namespace middleware {

class Manager
{
public:
    Manager() : up(false) {}
    virtual ~Manager() {}

    bool run() { return up = true; }
    bool check() { return false; }
    void stop() { up = false; }

protected:
    virtual void onExecutableDied(const std::string &module) = 0;

private:
    bool up;
};

} // namespace middleware

class PaperRig : public RTF::FixtureManager, middleware::Manager
{
public:
    virtual bool setup(int argc, char **argv)
    {
        RTF_ASSERT_ERROR_IF(argc == 1, "tell what to start");
        RTF::Asserter::report(RTF::TestMessage(std::string(argv[0]) + " is up"),
                              dynamic_cast<RTF::TestSuite *>(getDispatcher()));
        return Manager::run();
    }

    virtual bool check() { return true; }

    virtual void tearDown() { Manager::stop(); }

protected:
    virtual void onExecutableDied(const std::string &module)
    {
        getDispatcher()->fixtureCollapsed(module + " died");
    }
};
