// SPDX-License-Identifier: Apache-2.0
// An episode test that takes as many episodes as there are slots, and finishes the last one first.
// Its parameter `payload` selects what an episode does, and that of the test how it ends.
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include <rtf/EpisodeTest.hpp>

using namespace std::chrono_literals;

class Slots : public rtf::EpisodeTest
{
public:
    void run() override
    {
        std::vector<rtf::Episode> open;
        for (;;) {
            for (rtf::Episode &next : take(0, open.empty())) {
                open.push_back(std::move(next));
            }
            if (open.empty()) {
                return;
            }
            rtf::Episode last = std::move(open.back());
            open.pop_back();
            std::ofstream("log", std::ios::app) << getpid() << ' ' << last.id() << '\n';
            end(last);
            if (param() == "twice") {
                last.finish();
            }
            if (param() == "early") {
                return;
            }
        }
    }

private:
    // A critical problem ends the test; any other one ends the episode.
    void end(rtf::Episode &last)
    {
        const std::string payload = last.parameter("payload", "0");
        if (last.within([&] { act(last, payload); })) {
            last.finish(payload != "4", "dropped");
        }
    }

    void act(rtf::Episode &last, const std::string &payload)
    {
        last.observe(std::vector<std::uint32_t>{last.seed()});
        while (last.step(0.5s) && payload == "6") {
        }
        measure("distance", static_cast<double>(last.id()), "m");
        switch (std::stoi(payload)) {
        case 1:
            RTF_CHECK(false, "too heavy");
            return;
        case 2:
            throw std::runtime_error("no simulator");
        case 3:
            RTF_CASE("grasp")
            {
                RTF_REQUIRE(false, "slipped");
            };
            return;
        case 5:
            skip("no gripper");
        case 9:
            std::abort();
        default:
            return;
        }
    }
};

RTF_PLUGIN(Slots)
