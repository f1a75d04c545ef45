// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class Skip : public rtf::TestCase
{
public:
    void tearDown() override { report("torn down"); }

    void run() override
    {
        report("before");
        skip("no camera");
        report("after");
    }
};

RTF_PLUGIN(Skip);
