// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class Context : public rtf::TestCase
{
public:
    void run() override
    {
        report(name() + " " + param() + " " + environment() + " " + std::to_string(repetition()));
    }
};

RTF_PLUGIN(Context);
