// SPDX-License-Identifier: Apache-2.0
// Runs N cases (its argument) with a check each.
#include <string>

#include <rtf/rtf.hpp>

class Cases : public rtf::TestCase
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
            RTF_CASE("pose " + std::to_string(index))
            {
                held_ = held_ && index < count_;
            };
        }
        RTF_CHECK(held_, "every pose was reached");
    }

private:
    long count_ = 0;
    bool held_ = true;
};

RTF_PLUGIN(Cases);
