// Kills the module that the fixture monitors, and is then stopped.
#include <rtf/TestAssert.h>
#include <rtf/TestCase.h>
#include <rtf/dll/Plugin.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

class KillerTest : public RTF::TestCase
{
public:
    KillerTest() : TestCase("KillerTest"), stopped(false) {}

    virtual bool setup(int argc, char **argv)
    {
        RTF_ASSERT_ERROR_IF(argc == 2, "tell what to kill");
        module = argv[1];
        return true;
    }

    virtual void run()
    {
        std::ofstream(module.c_str()) << "dead";
        while (!stopped) {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        RTF_TEST_REPORT("stopped when asked to");
    }

    virtual void interrupt() { stopped = true; }

private:
    std::string module;
    std::atomic<bool> stopped;
};

PREPARE_PLUGIN(KillerTest)
