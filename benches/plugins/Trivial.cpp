// SPDX-License-Identifier: Apache-2.0
// A test that does nothing, to measure the overhead.
#include <rtf/rtf.hpp>

class Trivial : public rtf::TestCase
{
public:
    void run() override { RTF_CHECK(true, "nothing is wrong"); }
};

RTF_PLUGIN(Trivial);
