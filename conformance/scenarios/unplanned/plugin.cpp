// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class Unplanned : public rtf::TestCase
{
public:
    void run() override
    {
        plan_cases({"a", "b"});
        RTF_CASE("a"){};
    }
};

RTF_PLUGIN(Unplanned);
