// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class Error : public rtf::TestCase
{
public:
    void run() override { RTF_ERROR("no encoder found"); }

    void tearDown() override { report("torn down"); }
};

RTF_PLUGIN(Error);
