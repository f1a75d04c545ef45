// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include <stdlib.h>

#include <rtf/TestCase.hpp>

using namespace std::chrono_literals;

class Ask : public rtf::TestCase
{
public:
    void run() override
    {
        std::string folder = std::filesystem::temp_directory_path() / "rtf-ask-XXXXXX";
        if (mkdtemp(folder.data()) == nullptr) {
            RTF_ERROR("cannot make a folder");
        }
        const std::string picture = folder + "/hand.png";
        std::ofstream(picture, std::ios::binary) << "\x89PNG\r\n\x1a\n";
        report("answer: " + ask("Is the hand\nclosed?", {"yes", "no"}, 20s, "no", picture));
        std::filesystem::remove_all(folder);
        RTF_CASE("serial number")
        {
            report("answer: " + ask("Serial number?", {}, 5min, "SN-17"));
        };
        instruct("Push the button", "", 1500ms, "done");
        report("pushed");
    }
};

RTF_PLUGIN(Ask);
