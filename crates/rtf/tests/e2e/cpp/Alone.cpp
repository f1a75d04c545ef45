// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <string>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <rtf/TestCase.hpp>

/// Fails when another process of this folder is in it, too. The kernel frees
/// the name when the process dies.
class Alone : public rtf::TestCase
{
public:
    void run() override
    {
        char folder[64];
        RTF_REQUIRE(getcwd(folder, sizeof folder) != nullptr, "the folder is known");
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::strcpy(address.sun_path + 1, folder);
        const int mark = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
        const auto *name = reinterpret_cast<const sockaddr *>(&address);
        const bool alone = bind(mark, name, sizeof address) == 0;
        RTF_CHECK(alone, "nobody else is here");
        usleep(1000);
        close(mark);
    }
};

RTF_PLUGIN(Alone);
