// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class SkipInSetup : public rtf::TestCase
{
public:
    bool setup(int, char **) override
    {
        skip("no robot");
        return true;
    }

    void tearDown() override { report("torn down"); }

    void run() override { report("never"); }
};

RTF_PLUGIN(SkipInSetup);
