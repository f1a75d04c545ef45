// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <cstring>

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include <rtf/TestCase.hpp>

// Writes an invalid line to every socket of the process: one of them is the channel.
class Garbage : public rtf::TestCase
{
public:
    void run() override
    {
        report("before the garbage");
        DIR *directory = opendir("/proc/self/fd");
        if (directory == nullptr) {
            RTF_ERROR("cannot list the descriptors");
        }
        const char line[] = "this is not a message\n";
        const ssize_t length = static_cast<ssize_t>(std::strlen(line));
        while (const dirent *entry = readdir(directory)) {
            const int descriptor = std::atoi(entry->d_name);
            struct stat status;
            const bool is_number = entry->d_name[0] != '.';
            if (is_number && fstat(descriptor, &status) == 0 && S_ISSOCK(status.st_mode) &&
                write(descriptor, line, std::strlen(line)) != length) {
                RTF_ERROR("cannot write the garbage");
            }
        }
        closedir(directory);
    }
};

RTF_PLUGIN(Garbage);
