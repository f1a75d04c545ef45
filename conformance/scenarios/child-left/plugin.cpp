// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <rtf/TestCase.hpp>

class ChildLeft : public rtf::TestCase
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
            execlp("sleep", "rtf-left-behind", "1000", static_cast<char *>(nullptr));
            _exit(127);
        }
        report("child started");
    }
};

RTF_PLUGIN(ChildLeft);
