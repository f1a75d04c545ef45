// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <thread>

#include <rtf/TestCase.hpp>

class Hang : public rtf::TestCase
{
public:
    void run() override
    {
        report("going to hang");
        for (;;) {
            std::this_thread::sleep_for(std::chrono::hours(1));
        }
    }
};

RTF_PLUGIN(Hang);
