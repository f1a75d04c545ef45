// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include <rtf/TestCase.hpp>

class WaitUntil : public rtf::TestCase
{
public:
    void run() override
    {
        wait_until([] { return false; }, std::chrono::milliseconds(200), "the door to open");
    }
};

RTF_PLUGIN(WaitUntil);
