// SPDX-License-Identifier: Apache-2.0
// The critical first test of a long suite; the others are skipped.
#include <rtf/rtf.hpp>

class Fails : public rtf::TestCase
{
public:
    void run() override { RTF_FAIL("the rest is skipped"); }
};

RTF_PLUGIN(Fails);
