// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <fstream>

#include <rtf/TestCase.hpp>

class FaultTest : public rtf::TestCase
{
public:
    void run() override
    {
        const rtf::Fault lost = fault("drop");
        RTF_CHECK(stands(), "the camera stands");
        lost.remove();
        lost.remove();
        const long before = ticks();
        wait_until([&] { return ticks() > before; }, std::chrono::seconds(30), "the camera to run");
        fault("drop");
        RTF_CHECK(stands(), "the camera stands again");
        fault("drop");
        report("not reached");
    }

private:
    static long ticks()
    {
        long count = 0;
        std::ifstream("tick") >> count;
        return count;
    }

    bool stands() const
    {
        const long before = ticks();
        sleep(std::chrono::milliseconds(150));
        return ticks() == before;
    }
};

RTF_PLUGIN(FaultTest);
