// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <rtf/TestCase.hpp>

using namespace std::chrono_literals;

/// Runs cases as its parameter says.
class Cases : public rtf::TestCase
{
public:
    void run() override
    {
        const std::string what = param();
        if (what == "threads") {
            onThreads();
        } else if (what == "fork") {
            forks();
        } else if (what == "late") {
            late_ = std::thread([this] {
                while (!isTornDown_) {
                    std::this_thread::sleep_for(1ms);
                }
                RTF_CASE("late")
                {
                    report("never");
                };
            });
        } else if (what == "stuck") {
            RTF_CASE("bench")
            {
                RTF_CASE("arm")
                {
                    sleep(1h);
                };
            };
        } else if (what == "samples") {
            sample("current", 1, "A");
            RTF_CASE("moves")
            {
                sample("current", 2, "A");
                measure("time", 3, "s");
                attach("/proc/self/comm", "comm");
            };
            sample("current", 4, "A");
        } else if (what == "names") {
            RTF_CASE("line 1\nline 2 \x1b[31mred \xff")
            {
                RTF_CHECK(false, "it moves");
            };
            RTF_CASE(""){};
        } else if (what.find(" cases") != std::string::npos) {
            const int count = std::stoi(what);
            for (int number = 0; number < count; ++number) {
                RTF_CASE("case " + std::to_string(number)){};
            }
        }
    }

    void tearDown() override
    {
        isTornDown_ = true;
        if (late_.joinable()) {
            late_.join();
        }
    }

private:
    /// Each report names the case in which it is expected.
    void onThreads()
    {
        RTF_CASE("main")
        {
            const auto cases = [this](const std::string &side) {
                for (int number = 0; number < 200; ++number) {
                    const std::string name = side + " " + std::to_string(number);
                    RTF_CASE(name)
                    {
                        report(name);
                        RTF_CASE("inner")
                        {
                            report(name + "/inner");
                        };
                    };
                }
            };
            std::thread left(cases, "left");
            std::thread right(cases, "right");
            std::thread([this] { report("main"); }).join();
            left.join();
            right.join();
            report("main");
        };
    }

    void forks()
    {
        RTF_CASE("parent")
        {
            const pid_t child = fork();
            if (child == 0) {
                RTF_CASE("child")
                {
                    report("from the child");
                };
                report("after the child's case");
                return;
            }
            waitpid(child, nullptr, 0);
            report("from the parent");
        };
    }

    std::thread late_;
    std::atomic<bool> isTornDown_{false};
};

RTF_PLUGIN(Cases);
