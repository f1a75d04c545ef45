// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include <rtf/TestCase.hpp>

class ExitZero : public rtf::TestCase
{
public:
    void run() override
    {
        RTF_CHECK(false, "already wrong");
        std::exit(0);
    }
};

RTF_PLUGIN(ExitZero);
