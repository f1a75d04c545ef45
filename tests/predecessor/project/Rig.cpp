// A fixture that logs its calls, and fails in the way of its argument.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include <robottestingframework/FixtureManager.h>
#include <robottestingframework/TestAssert.h>
#include <robottestingframework/TestSuite.h>
#include <robottestingframework/dll/Plugin.h>

using namespace robottestingframework;

class Rig : public FixtureManager
{
public:
    ~Rig() override
    {
        if (watchdog.joinable()) {
            watchdog.join();
        }
    }

    bool setup(int argc, char **argv) override
    {
        name = argc > 1 ? argv[1] : "rig";
        how = argc > 2 ? argv[2] : "";
        log("up");
        // As YARP's fixtures report.
        TestSuite *const suite = dynamic_cast<TestSuite *>(getDispatcher());
        ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_FALSE(suite != nullptr, "the dispatcher is no suite");
        Asserter::report(TestMessage("reports", name + " is up", __FILE__, __LINE__), suite);
        if (how == "throw") {
            throw FixtureException(TestMessage("no power"));
        }
        if (how == "collapse" && !watchdog.joinable() && !std::ifstream(marks() + ".go")) {
            watchdog = std::thread([this] { watch(); });
        }
        return how != "false";
    }

    bool check() override { return true; }

    void tearDown() override { log("down"); }

private:
    static std::string marks() { return std::getenv("BENCH_LOG"); }

    // Collapses at a test's request.
    void watch()
    {
        while (!std::ifstream(marks() + ".go")) {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        getDispatcher()->fixtureCollapsed(TestMessage("the motor is too hot"));
        std::ofstream(marks() + ".told");
    }

    void log(const char *what) const
    {
        if (const char *path = std::getenv("BENCH_LOG")) {
            FILE *file = std::fopen(path, "a");
            std::fprintf(file, "%s %s\n", name.c_str(), what);
            std::fclose(file);
        }
    }

    std::string name;
    std::string how;
    std::thread watchdog;
};

ROBOTTESTINGFRAMEWORK_PREPARE_FIXTURE_PLUGIN(Rig)
