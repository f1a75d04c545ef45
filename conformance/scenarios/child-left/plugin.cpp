// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <unistd.h>

#include <rtf/TestCase.hpp>

class ChildLeft : public rtf::TestCase
{
public:
    void run() override
    {
        // Closed by the exec: until then the child still looks like its host.
        int started[2];
        if (pipe2(started, O_CLOEXEC) != 0) {
            RTF_ERROR("cannot make a pipe");
        }
        const pid_t child = fork();
        if (child < 0) {
            RTF_ERROR("cannot fork");
        }
        if (child == 0) {
            setsid();
            execlp("sleep", "rtf-left-behind", "1000", static_cast<char *>(nullptr));
            _exit(127);
        }
        close(started[1]);
        char byte;
        while (read(started[0], &byte, 1) > 0) {
        }
        report("child started");
    }
};

RTF_PLUGIN(ChildLeft);
