// A fixture as in the paper: it is also a middleware's manager, whose watchdog
// thread calls it when a module dies.
#include <FixtureManager.h>
#include <dll/Plugin.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <string>
#include <thread>

namespace middleware {

// Third-party code that starts and monitors modules.
class Manager
{
public:
    Manager() : stopping(false) {}
    virtual ~Manager() { stop(); }

    bool run(const std::string &file)
    {
        watched = file;
        watchdog = std::thread(&Manager::watch, this);
        return true;
    }

    void stop()
    {
        stopping = true;
        if (watchdog.joinable()) {
            watchdog.join();
        }
    }

protected:
    virtual void onExecutableDied(const std::string &module) = 0;

private:
    void watch()
    {
        while (!stopping && !std::ifstream(watched.c_str())) {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        if (!stopping) {
            onExecutableDied(watched);
        }
    }

    std::string watched;
    std::atomic<bool> stopping;
    std::thread watchdog;
};

} // namespace middleware

class WatchedRig : public middleware::Manager, public RTF::FixtureManager
{
public:
    virtual bool setup(int argc, char **argv) { return argc == 1 && run(argv[0]); }

    virtual void tearDown() { stop(); }

protected:
    virtual void onExecutableDied(const std::string &)
    {
        getDispatcher()->fixtureCollapsed("the simulator died");
    }
};

PREPARE_FIXTURE_PLUGIN(WatchedRig)
