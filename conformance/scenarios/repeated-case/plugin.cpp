// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class RepeatedCase : public rtf::TestCase
{
public:
    void run() override
    {
        for (int round = 0; round < 2; ++round) {
            RTF_CASE("pose"){};
        }
    }
};

RTF_PLUGIN(RepeatedCase);
