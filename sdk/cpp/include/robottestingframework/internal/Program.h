// SPDX-License-Identifier: Apache-2.0
// Runs a program and waits for it.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_PROGRAM_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_PROGRAM_H

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <fcntl.h>
#include <ftw.h>
#include <spawn.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

namespace robottestingframework {
namespace internal {

class Program
{
public:
    // Runs it with its output in a file. Returns the exit code; -1 with error() if it
    // could not be started or was killed by a signal.
    int run(std::vector<std::string> words, const std::string &output)
    {
        std::vector<char *> arguments;
        for (std::string &word : words) {
            word.push_back('\0');
            arguments.push_back(&word[0]);
        }
        arguments.push_back(nullptr);

        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addopen(&actions, 1, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                         0600);
        posix_spawn_file_actions_adddup2(&actions, 1, 2);
        pid_t process = 0;
        const int problem =
            posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        if (problem != 0) {
            error_ = "cannot start " + std::string(arguments[0]) + ": " + std::strerror(problem);
            return -1;
        }
        process_ = process;
        const int code = wait(process);
        process_ = 0;
        return code;
    }

    // Interrupts it like Ctrl-C, from another thread.
    void interrupt()
    {
        const pid_t process = process_;
        if (process > 0) {
            kill(process, SIGINT);
        }
    }

    const std::string &error() const { return error_; }

private:
    int wait(pid_t process)
    {
        int status = 0;
        while (waitpid(process, &status, 0) < 0) {
            if (errno != EINTR) {
                error_ = std::string("waitpid: ") + std::strerror(errno);
                return -1;
            }
        }
        if (WIFEXITED(status)) {
            return WEXITSTATUS(status);
        }
        error_ = "ended by signal " + std::to_string(WTERMSIG(status));
        return -1;
    }

    std::atomic<pid_t> process_{0};
    std::string error_;
};

// A temporary directory, removed with this object. Its path is empty if it could not
// be created.
class TemporaryFolder
{
public:
    TemporaryFolder()
    {
        const char *const top = std::getenv("TMPDIR");
        std::string path = (top == nullptr || *top == '\0' ? "/tmp" : top);
        path += "/rtf-XXXXXX";
        path.push_back('\0');
        if (mkdtemp(&path[0]) != nullptr) {
            path_.assign(path, 0, path.size() - 1);
        }
    }
    ~TemporaryFolder()
    {
        if (!path_.empty()) {
            nftw(path_.c_str(), discard, 16, FTW_DEPTH | FTW_PHYS);
        }
    }
    TemporaryFolder(const TemporaryFolder &) = delete;
    TemporaryFolder &operator=(const TemporaryFolder &) = delete;

    const std::string &path() const { return path_; }

private:
    static int discard(const char *path, const struct stat *, int, struct FTW *)
    {
        return std::remove(path);
    }

    std::string path_;
};

} // namespace internal
} // namespace robottestingframework

#endif
