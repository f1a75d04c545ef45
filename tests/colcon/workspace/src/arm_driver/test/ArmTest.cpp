// The parameter names a variable that makes the test fail, crash or skip itself.
#include "arm_driver/arm_driver.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <rtf/rtf.hpp>
#include <string>
#include <unistd.h>
#include <vector>

namespace {
std::string variable(const std::string &name)
{
    const char *value = std::getenv(name.c_str());
    return value ? value : "";
}
} // namespace

class ArmTest : public rtf::TestCase
{
public:
    bool setup(int argc, char **argv) override
    {
        behaviour_ = argc == 2 ? variable(argv[1]) : "";
        return true;
    }

    void run() override
    {
        RTF_REPORT("the arm moves");
        RTF_CHECK(variable("ARM_JOINTS") == "6", "the environment hook of arm_description");
        RTF_CHECK(variable("ARM_LIST") == "ab", "the environment of the suite");
        const int port = std::stoi(variable("RTF_FIXTURE_ARM_PORT"));
        RTF_CHECK_NEAR(ask_arm(port, 21), 42.0, 1e-9, "the answer of the arm");
        if (behaviour_ == "fail")
            RTF_FAIL("the arm is bent");
        if (behaviour_ == "crash")
            std::abort();
        if (behaviour_ == "skip")
            RTF_SKIP("no gripper");
        if (behaviour_ == "kill")
            kill_runner();
    }

    void tearDown() override {}

private:
    // Kills the program that runs the suite, and its guard: no report is written.
    static void kill_runner()
    {
        std::vector<pid_t> programs;
        for (pid_t pid = getppid(); pid > 1;) {
            std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
            std::string name;
            std::string state;
            stat >> pid >> name >> state;
            if (name == "(rtf)")
                programs.push_back(pid);
            stat >> pid;
        }
        // The guard first.
        std::for_each(programs.rbegin(), programs.rend(), [](pid_t pid) { kill(pid, SIGKILL); });
        pause();
    }

    std::string behaviour_;
};

RTF_PLUGIN(ArmTest)
