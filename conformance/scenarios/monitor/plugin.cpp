// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class Monitor : public rtf::TestCase
{
public:
    void run() override
    {
        sample("level", 5, "m");
        monitor("always(level < 2m)", "low");
        monitor("always(level > 0m)", "", rtf::Severity::stop);
        monitor("always(level < 2kg)", "wrong unit", rtf::Severity::error);
        sample("level", 1, "m");
        sample("level", 3, "m");
    }
};

RTF_PLUGIN(Monitor);
