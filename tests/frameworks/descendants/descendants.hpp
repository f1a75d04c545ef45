// What the cases of the programs `descendants_test` do: each starts processes,
// and holds or not. tests/frameworks/test_child_processes.py compares the verdicts
// under rtf with those without it.
#ifndef DESCENDANTS_HPP
#define DESCENDANTS_HPP

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

namespace descendants {

// In the environment of a descendant: whether its cases `pass` or `fail`.
constexpr const char *role_variable = "DESCENDANT_ROLE";

// A child that does not return from its case has this exit code, or this
// signal.
enum { OWN_CODE = 3, SIGNALLED = 128 };

inline bool is_descendant()
{
    return std::getenv(role_variable) != nullptr;
}

inline bool has_passed()
{
    return std::strcmp(std::getenv(role_variable), "pass") == 0;
}

// Waits for a child; its exit code, or SIGNALLED plus its signal.
inline int end_of(pid_t child)
{
    int status = 0;
    if (waitpid(child, &status, 0) != child) {
        return -1;
    }
    return WIFSIGNALED(status) ? SIGNALLED + WTERMSIG(status) : WEXITSTATUS(status);
}

// The strings of `/proc/self/cmdline` or `/proc/self/environ`.
inline std::vector<std::string> own_strings(const char *name)
{
    std::ifstream file(std::string("/proc/self/") + name);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    std::vector<std::string> strings;
    for (std::size_t at = 0; at < text.size(); at += strings.back().size() + 1) {
        strings.emplace_back(text.c_str() + at);
    }
    return strings;
}

inline std::vector<char *> pointers(std::vector<std::string> &strings)
{
    std::vector<char *> list;
    for (std::string &string : strings) {
        list.push_back(&string[0]);
    }
    list.push_back(nullptr);
    return list;
}

// Executes this program again with its arguments. Without its environment, the
// descendant only has its role. Its end, and what it wrote to standard output.
inline int execute(const char *role, bool has_environment, bool spawns, std::string &output)
{
    static std::vector<std::string> arguments = own_strings("cmdline");
    std::vector<std::string> variables{std::string(role_variable) + "=" + role};
    for (char **variable = environ; has_environment && *variable != nullptr; ++variable) {
        variables.emplace_back(*variable);
    }
    const std::vector<char *> argv = pointers(arguments);
    const std::vector<char *> envp = pointers(variables);
    int ends[2];
    if (pipe(ends) != 0) {
        return -1;
    }
    pid_t child = -1;
    if (spawns) {
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
        posix_spawn_file_actions_addclose(&actions, ends[0]);
        posix_spawn_file_actions_addclose(&actions, ends[1]);
        posix_spawn(&child, "/proc/self/exe", &actions, nullptr, argv.data(), envp.data());
        posix_spawn_file_actions_destroy(&actions);
    } else {
        child = fork();
        if (child == 0) {
            dup2(ends[1], STDOUT_FILENO);
            close(ends[0]);
            close(ends[1]);
            execve("/proc/self/exe", argv.data(), envp.data());
            _exit(127);
        }
    }
    close(ends[1]);
    char piece[4096];
    for (ssize_t size = 0; (size = read(ends[0], piece, sizeof piece)) > 0;) {
        output.append(piece, static_cast<std::size_t>(size));
    }
    close(ends[0]);
    return end_of(child);
}

inline int execute(const char *role, bool has_environment = true, bool spawns = false)
{
    std::string output;
    return execute(role, has_environment, spawns, output);
}

// The cases.

inline bool executes_itself()
{
    return execute("pass") == 0;
}

// The same again: the first descendant must not have taken anything away.
inline bool executes_itself_twice()
{
    return execute("pass") == 0 && execute("pass") == 0;
}

// The case fails, with or without rtf.
inline bool needs_a_descendant_that_fails()
{
    return execute("fail") == 0;
}

inline bool expects_a_descendant_that_fails()
{
    const int end = execute("fail");
    return end > 0 && end < SIGNALLED;
}

inline bool executes_itself_without_environment()
{
    return execute("pass", false) == 0;
}

inline bool expects_a_failure_without_environment()
{
    const int end = execute("fail", false);
    return end > 0 && end < SIGNALLED;
}

inline bool spawns_itself()
{
    return execute("pass", true, true) == 0;
}

inline bool needs_a_spawned_descendant_that_fails()
{
    return execute("fail", true, true) == 0;
}

inline bool reads_what_a_descendant_prints()
{
    std::string output;
    return execute("pass", true, false, output) == 0 &&
           output.find("a descendant prints") != std::string::npos;
}

// What rtf adds for the program itself.
inline bool has_an_environment_of_its_own()
{
    const char *const preloaded = std::getenv("LD_PRELOAD");
    return (preloaded == nullptr || std::strstr(preloaded, "librtf") == nullptr) &&
           std::getenv("RTF_REPORT") == nullptr && std::getenv("RTF_PROGRAM_FORKS") == nullptr &&
           std::getenv("ASAN_OPTIONS") == nullptr;
}

inline bool forks_and_exits()
{
    const pid_t child = fork();
    if (child == 0) {
        std::exit(0);
    }
    return end_of(child) == 0;
}

inline bool forks_and_exits_with_a_code()
{
    const pid_t child = fork();
    if (child == 0) {
        std::exit(OWN_CODE);
    }
    return end_of(child) == OWN_CODE;
}

inline bool forks_and_exits_at_once()
{
    const pid_t child = fork();
    if (child == 0) {
        _exit(OWN_CODE);
    }
    return end_of(child) == OWN_CODE;
}

inline bool forks_and_aborts()
{
    const pid_t child = fork();
    if (child == 0) {
        std::abort();
    }
    return end_of(child) == SIGNALLED + SIGABRT;
}

// The child continues with the other cases. Its exit code depends on the cases
// before this one.
inline bool forks_and_returns()
{
    const pid_t child = fork();
    if (child == 0) {
        setenv(role_variable, "pass", 1);
        return true;
    }
    const int end = end_of(child);
    return end >= 0 && end < SIGNALLED;
}

inline bool forks_and_fails()
{
    const pid_t child = fork();
    if (child == 0) {
        setenv(role_variable, "pass", 1);
        return false;
    }
    const int end = end_of(child);
    return end > 0 && end < SIGNALLED;
}

inline bool needs_a_fork_that_fails()
{
    const pid_t child = fork();
    if (child == 0) {
        setenv(role_variable, "fail", 1);
        return false;
    }
    return end_of(child) == 0;
}

inline bool passes()
{
    return true;
}

inline bool fails()
{
    return false;
}

// Whether a case holds. In a descendant, all cases have the same result.
inline bool holds(bool (*deed)())
{
    if (is_descendant()) {
        std::puts("a descendant prints");
        std::fflush(stdout);
        return has_passed();
    }
    return deed();
}

} // namespace descendants

#define DESCENDANTS(CASE)                                                                          \
    CASE(executes_itself)                                                                          \
    CASE(executes_itself_twice)                                                                    \
    CASE(needs_a_descendant_that_fails)                                                            \
    CASE(expects_a_descendant_that_fails)                                                          \
    CASE(executes_itself_without_environment)                                                      \
    CASE(expects_a_failure_without_environment)                                                    \
    CASE(spawns_itself)                                                                            \
    CASE(needs_a_spawned_descendant_that_fails)                                                    \
    CASE(reads_what_a_descendant_prints)                                                           \
    CASE(has_an_environment_of_its_own)                                                            \
    CASE(forks_and_exits)                                                                          \
    CASE(forks_and_exits_with_a_code)                                                              \
    CASE(forks_and_exits_at_once)                                                                  \
    CASE(forks_and_aborts)                                                                         \
    CASE(forks_and_returns)                                                                        \
    CASE(forks_and_fails)                                                                          \
    CASE(needs_a_fork_that_fails)                                                                  \
    CASE(passes)                                                                                   \
    CASE(fails)

#endif
