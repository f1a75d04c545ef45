// SPDX-License-Identifier: Apache-2.0
// Samples a signal N times (its argument).
#include <string>

#include <rtf/rtf.hpp>

class Samples : public rtf::TestCase
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
            sample("position", static_cast<double>(index % 1000) / 1000, "rad");
        }
    }

private:
    long count_ = 0;
};

RTF_PLUGIN(Samples);
