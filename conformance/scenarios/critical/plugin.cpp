// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class Critical : public rtf::TestCase
{
public:
    void run() override { RTF_REQUIRE_CRITICAL(false, "the emergency stop is pressed"); }
};

RTF_PLUGIN(Critical);
