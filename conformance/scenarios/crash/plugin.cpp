// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class Crash : public rtf::TestCase
{
public:
    void run() override
    {
        report("before the crash");
        volatile int *volatile nowhere = nullptr;
        *nowhere = 1;
    }
};

RTF_PLUGIN(Crash);
