// SPDX-License-Identifier: Apache-2.0
// A fixture plug-in whose host is killed; it writes its process id to a file.
#include <unistd.h>

#include <rtf/FixtureManager.hpp>
#include <rtf/rtf.hpp>

#include "collapse.h"

class VictimFixture : public rtf::FixtureManager
{
public:
    bool setup(int argc, char **argv) override
    {
        return argc == 2 && write_pid(argv[1], getpid()) == 0;
    }
};

RTF_PLUGIN(VictimFixture);
