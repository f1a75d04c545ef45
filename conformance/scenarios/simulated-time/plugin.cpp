// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include <rtf/TestCase.hpp>

class SimulatedTime : public rtf::TestCase
{
public:
    void run() override
    {
        const auto start = now();
        sleep(std::chrono::seconds(20));
        RTF_CHECK(now() - start >= std::chrono::seconds(20), "twenty seconds have passed");
        wait_until([] { return false; }, std::chrono::seconds(10), "the door to open");
    }
};

RTF_PLUGIN(SimulatedTime);
