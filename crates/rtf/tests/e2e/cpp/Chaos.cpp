// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>
#include <unistd.h>

#include <rtf/TestCase.hpp>

/// Ends its own process in the step, and in the way, that its parameter says; tells in
/// files that it began, and that it came to its end.
class Chaos : public rtf::TestCase
{
public:
    bool setup(int, char **) override
    {
        tell("began");
        act("setup");
        return true;
    }

    void run() override
    {
        report(std::string(param() == "wait" ? 200000 : 10, 'x'));
        if (param() == "wait") {
            sleep(std::chrono::milliseconds(3));
        }
        act("run");
        RTF_CHECK(param() != "fail", "it was not asked to fail");
    }

    void tearDown() override
    {
        act("tear-down");
        tell("ended");
    }

private:
    void tell(const std::string &what) const
    {
        std::ofstream(name() + "." + what, std::ios::app) << getpid() << '\n';
    }

    void act(const std::string &step) const
    {
        if (param() == "kill " + step) {
            kill(getpid(), SIGKILL);
        }
        if (param() == "exit " + step) {
            _exit(0);
        }
    }
};

RTF_PLUGIN(Chaos);
