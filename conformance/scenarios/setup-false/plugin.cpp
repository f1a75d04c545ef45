// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class SetupFalse : public rtf::TestCase
{
public:
    bool setup(int, char **) override { return false; }

    void run() override { report("never"); }

    void tearDown() override { report("torn down"); }
};

RTF_PLUGIN(SetupFalse);
