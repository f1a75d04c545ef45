// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include <rtf/TestCase.hpp>

class AskInTearDown : public rtf::TestCase
{
public:
    void run() override { report("running"); }

    void tearDown() override
    {
        ask("Is the hand closed?", {}, std::chrono::seconds(1), "no");
        report("not reached");
    }
};

RTF_PLUGIN(AskInTearDown);
