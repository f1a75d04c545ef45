// SPDX-License-Identifier: Apache-2.0
// A fixture that collapses from a thread of its own, once, when the file `go`
// appears; and one whose check fails, once, with the argument `--check`.
#include <chrono>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>

#include <rtf/FixtureManager.hpp>

class Driver : public rtf::FixtureManager
{
public:
    bool setup(int argc, char **argv) override
    {
        checks_ = argc > 1 && std::strcmp(argv[1], "--check") == 0;
        if (!checks_ && !exists("collapsed")) {
            watchdog_ = std::thread([this] {
                while (!exists("go") && !interrupted()) {
                    std::this_thread::sleep_for(std::chrono::milliseconds(5));
                }
                std::ofstream("collapsed") << "yes";
                getDispatcher()->fixtureCollapsed("the watchdog lost the motor");
            });
        }
        return true;
    }

    bool check() override
    {
        if (!checks_ || exists("checked")) {
            return true;
        }
        std::ofstream("checked") << "yes";
        return false;
    }

    void tearDown() override
    {
        if (watchdog_.joinable()) {
            watchdog_.join();
        }
        std::ofstream("torn-down", std::ios::app) << "x";
    }

private:
    static bool exists(const char *name) { return std::ifstream(name).good(); }

    bool checks_ = false;
    std::thread watchdog_;
};

RTF_PLUGIN(Driver)
