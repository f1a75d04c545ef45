// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include <rtf/TestCase.hpp>

class Abort : public rtf::TestCase
{
public:
    void run() override
    {
        report("before the abort");
        std::abort();
    }
};

RTF_PLUGIN(Abort);
