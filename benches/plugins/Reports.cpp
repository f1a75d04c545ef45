// SPDX-License-Identifier: Apache-2.0
// Reports N times (its argument).
#include <string>

#include <rtf/rtf.hpp>

class Reports : public rtf::TestCase
{
public:
    bool setup(int argc, char **argv) override
    {
        count_ = argc > 1 ? std::stol(argv[1]) : 0;
        return count_ > 0;
    }

    void run() override
    {
        for (long index = 0; index < count_; ++index) {
            RTF_REPORT("joint 3 moved to its next position");
        }
    }

private:
    long count_ = 0;
};

RTF_PLUGIN(Reports);
