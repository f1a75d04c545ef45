// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <cstdio>
#include <iostream>
#include <unistd.h>

#include <rtf/TestCase.hpp>

/// Prints whole lines in all ways, then ends its process as its parameter says.
class Prints : public rtf::TestCase
{
public:
    void run() override
    {
        // It flushes the others first.
        std::cerr << "by cerr\n";
        std::printf("by %s\n", "printf");
        std::cout << "by cout\n";
        if (param() == "crash") {
            raise(SIGSEGV);
        }
        if (param() == "kill") {
            raise(SIGKILL);
        }
        if (param() == "exit") {
            _exit(0);
        }
        for (;;) {
            pause();
        }
    }
};

RTF_PLUGIN(Prints);
