// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <string>

#include <stdlib.h>

#include <rtf/TestCase.hpp>

class Attach : public rtf::TestCase
{
public:
    void run() override
    {
        std::string folder = std::filesystem::temp_directory_path() / "rtf-attach-XXXXXX";
        if (mkdtemp(folder.data()) == nullptr) {
            RTF_ERROR("cannot make a folder");
        }
        const std::string path = folder + "/trace.csv";
        std::ofstream(path) << "t,q\n0,1\n";
        attach(path, "trace.csv", "text/csv");
        std::filesystem::remove_all(folder);
    }
};

RTF_PLUGIN(Attach);
