// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <rtf/TestCase.hpp>

/// Leaves a copy of its own process behind, which executes nothing.
class Copy : public rtf::TestCase
{
public:
    void run() override
    {
        const pid_t child = fork();
        if (child < 0) {
            RTF_ERROR("cannot fork");
        }
        if (child == 0) {
            setsid();
            for (;;) {
                pause();
            }
        }
    }
};

RTF_PLUGIN(Copy);
