// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class ForeignException : public rtf::TestCase
{
public:
    void run() override { throw 42; }
};

RTF_PLUGIN(ForeignException);
