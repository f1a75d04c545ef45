// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include <rtf/TestCase.hpp>

class InterruptedSleep : public rtf::TestCase
{
public:
    void run() override
    {
        report("sleeping");
        sleep(std::chrono::seconds(1000));
    }

    void tearDown() override { report("torn down"); }
};

RTF_PLUGIN(InterruptedSleep);
