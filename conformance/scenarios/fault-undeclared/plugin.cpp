// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class FaultUndeclared : public rtf::TestCase
{
public:
    void run() override
    {
        fault("drop");
        report("not reached");
    }
};

RTF_PLUGIN(FaultUndeclared);
