// SPDX-License-Identifier: Apache-2.0
#include <rtf/TestCase.hpp>

class AskUnanswered : public rtf::TestCase
{
public:
    void run() override
    {
        ask("Is the hand closed?", {"yes", "no"});
        report("not reached");
    }

    void tearDown() override { report("torn down"); }
};

RTF_PLUGIN(AskUnanswered);
