// SPDX-License-Identifier: Apache-2.0
// A test of a campaign that tells its process and episode, and crashes if the payload is 9.
#include <cstdlib>
#include <fstream>
#include <string>

#include <unistd.h>

#include <rtf/TestCase.hpp>

class Grasp : public rtf::TestCase
{
public:
    void run() override
    {
        const std::string payload = std::getenv("RTF_PARAM_PAYLOAD");
        std::ofstream("log", std::ios::app) << getpid() << ' ' << std::getenv("RTF_EPISODE") << ' '
                                            << payload << ' ' << param() << '\n';
        if (payload == "9") {
            std::abort();
        }
        RTF_CHECK(std::stod(payload) < 2, "too heavy");
    }
};

RTF_PLUGIN(Grasp)
