// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <rtf/TestCase.hpp>

class OutputFlood : public rtf::TestCase
{
public:
    void run() override
    {
        for (int line = 0; line < 1000000; ++line) {
            std::printf("flood line %d\n", line);
        }
    }
};

RTF_PLUGIN(OutputFlood);
