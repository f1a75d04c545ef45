// SPDX-License-Identifier: Apache-2.0
// librtf-fork-server.so: rtf preloads it (LD_PRELOAD) into a program whose cases run in a
// process each. The program is executed and linked once; it stops before its first
// constructor or before `main`, and forks a process for each case, the next one ahead. See
// "Forked programs" in spec/frameworks.md.
//
// It uses the C library only, because the program may not contain C++.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/sched.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include "command_line.h"

// The number of the descriptor at which the supervisor is connected, and `,main` to stop before
// `main`.
#define SOCKET_VARIABLE "RTF_PROGRAM_FORKS"

// The longest request, and the number of descriptors in it.
enum { REQUEST_BYTES = 192 * 1024, MAX_DESCRIPTORS = 4 };

// The links of a directory that do not stand for a thread: `.` and `..`.
enum { OWN_LINKS = 2 };

// The exit code of a process that could not become the program.
enum { FAILED = 127 };

typedef int (*Main)(int, char **, char **);
typedef int (*Start)(Main, int, char **, void (*)(void), void (*)(void), void (*)(void), void *);

// A request: NUL-terminated strings, and descriptors.
struct Request
{
    char *text;
    size_t length;
    int descriptors[MAX_DESCRIPTORS];
    int descriptor_count;
};

// What the C library's `fork` restores in the only thread of a new process.
struct Thread
{
    pid_t *tid;
    void *robust_list;
    size_t robust_list_bytes;
};

static int read_thread(struct Thread *thread)
{
    if (prctl(PR_GET_TID_ADDRESS, &thread->tid) != 0) {
        return -1;
    }
    if (syscall(SYS_get_robust_list, 0, &thread->robust_list, &thread->robust_list_bytes) != 0) {
        return -1;
    }
    return thread->tid != NULL && *thread->tid == syscall(SYS_gettid) ? 0 : -1;
}

// Forks a child of this process's parent, which so learns its end from the kernel.
static long fork_sibling(const struct Thread *thread)
{
    const unsigned long flags =
        CLONE_PARENT | CLONE_CHILD_SETTID | CLONE_CHILD_CLEARTID | (unsigned long)SIGCHLD;
    // The order of the last two arguments depends on the processor; the one for thread-local
    // storage is ignored without its flag.
    const long pid = syscall(SYS_clone, flags, 0, 0, thread->tid, thread->tid);
    if (pid == 0) {
        syscall(SYS_set_robust_list, thread->robust_list, thread->robust_list_bytes);
    }
    return pid;
}

static int has_one_thread(void)
{
    struct stat tasks;
    return stat("/proc/self/task", &tasks) == 0 && tasks.st_nlink == OWN_LINKS + 1;
}

static void answer(int socket, long number)
{
    char text[32];
    const int length = snprintf(text, sizeof text, "%ld", number);
    while (send(socket, text, (size_t)length, MSG_NOSIGNAL) < 0 && errno == EINTR) {
    }
}

// Returns false at the end, and after a damaged request.
static int receive(int socket, struct Request *request)
{
    union {
        struct cmsghdr header;
        char bytes[CMSG_SPACE(MAX_DESCRIPTORS * sizeof(int))];
    } control;
    struct iovec into = {request->text, REQUEST_BYTES - 1};
    struct msghdr message = {0};
    ssize_t length = -1;
    message.msg_iov = &into;
    message.msg_iovlen = 1;
    message.msg_control = control.bytes;
    message.msg_controllen = sizeof control.bytes;
    do {
        length = recvmsg(socket, &message, MSG_CMSG_CLOEXEC);
    } while (length < 0 && errno == EINTR);
    if (length <= 0 || (message.msg_flags & (MSG_TRUNC | MSG_CTRUNC)) != 0) {
        return 0;
    }
    request->length = (size_t)length;
    request->text[length] = '\0';
    request->descriptor_count = 0;
    for (struct cmsghdr *part = CMSG_FIRSTHDR(&message); part != NULL;
         part = CMSG_NXTHDR(&message, part)) {
        if (part->cmsg_level == SOL_SOCKET && part->cmsg_type == SCM_RIGHTS) {
            const size_t bytes = part->cmsg_len - CMSG_LEN(0);
            memcpy(request->descriptors, CMSG_DATA(part), bytes);
            request->descriptor_count = (int)(bytes / sizeof(int));
        }
    }
    return 1;
}

static char *next(char *string)
{
    return string + strlen(string) + 1;
}

// Gives the received descriptors the numbers in `list`, as in `1,2,5`.
static void place_descriptors(struct Request *request, char *list)
{
    int numbers[MAX_DESCRIPTORS];
    int free_from = 0;
    for (int index = 0; index < request->descriptor_count; ++index) {
        numbers[index] = (int)strtol(list, &list, 10);
        list += *list == ',';
        free_from = numbers[index] >= free_from ? numbers[index] + 1 : free_from;
    }
    for (int index = 0; index < request->descriptor_count; ++index) {
        // A received descriptor can have the number that another one gets.
        const int moved = fcntl(request->descriptors[index], F_DUPFD_CLOEXEC, free_from);
        if (moved < 0) {
            _exit(FAILED);
        }
        close(request->descriptors[index]);
        request->descriptors[index] = moved;
    }
    for (int index = 0; index < request->descriptor_count; ++index) {
        if (dup2(request->descriptors[index], numbers[index]) < 0) {
            _exit(FAILED);
        }
        close(request->descriptors[index]);
    }
}

// The arguments and after them the environment, as the kernel gives them to a program.
static char **program_strings(const struct Request *request, char *string, int *count)
{
    const char *const end = request->text + request->length;
    size_t variables = 0;
    const long arguments = strtol(string, NULL, 10);
    char **argument = NULL;
    char **strings = NULL;
    string = next(string);
    char *const first = string;
    for (long index = 0; index < arguments; ++index) {
        string = next(string);
    }
    rtf_set_command_line(first, string);
    for (; string < end; string = next(string)) {
        // The memory of the request stays: nothing is copied.
        if (strchr(string, '=') == NULL) {
            unsetenv(string);
        } else {
            putenv(string);
        }
    }
    while (environ[variables] != NULL) {
        ++variables;
    }
    strings = malloc(((size_t)arguments + variables + 2) * sizeof *strings);
    if (strings == NULL) {
        _exit(FAILED);
    }
    argument = strings;
    string = first;
    for (long index = 0; index < arguments; ++index, string = next(string)) {
        *argument++ = string;
    }
    *argument++ = NULL;
    memcpy(argument, environ, (variables + 1) * sizeof *strings);
    *count = (int)arguments;
    return strings;
}

// Waits for a request in a process that was forked ahead, and becomes the program of it.
static char **await_request(int socket, int taken, int *count)
{
    static char text[REQUEST_BYTES];
    struct Request request = {.text = text};
    const char byte = 0;
    // The server forks the next process while this one runs.
    if (!receive(socket, &request) || write(taken, &byte, sizeof byte) != sizeof byte) {
        _exit(0);
    }
    close(taken);
    close(socket);
    // Until now, it was in the group of the server, by which the supervisor recognizes it.
    setpgid(0, 0);
    place_descriptors(&request, request.text);
    return program_strings(&request, next(request.text), count);
}

// Whether the process that was forked ahead has got a request.
static int was_taken(int taken)
{
    char byte = 0;
    ssize_t length = -1;
    do {
        length = read(taken, &byte, sizeof byte);
    } while (length < 0 && errno == EINTR);
    return length == sizeof byte;
}

// Keeps one process ahead of the requests. Returns the strings of the program in a new process,
// and NULL at the end of the server.
static char **serve(int socket, int *count)
{
    struct Thread thread;
    if (!has_one_thread() || read_thread(&thread) != 0) {
        answer(socket, -1);
        return NULL;
    }
    answer(socket, getpid());
    for (;;) {
        int taken[2];
        long pid = -1;
        if (pipe2(taken, O_CLOEXEC) == 0) {
            pid = fork_sibling(&thread);
        }
        if (pid == 0) {
            close(taken[0]);
            return await_request(socket, taken[1], count);
        }
        answer(socket, pid);
        if (pid < 0) {
            return NULL;
        }
        close(taken[1]);
        if (!was_taken(taken[0])) {
            return NULL;
        }
        close(taken[0]);
    }
}

// The program's `main`, and the socket of the server that stops before it.
static Main program_main;
static int main_socket;

// Called as `main`, after the program's own constructors.
static int serve_main(int argc, char **argv, char **environment)
{
    (void)environment;
    // What constructors have printed would be in the buffers of all processes.
    fflush(NULL);
    argv = serve(main_socket, &argc);
    // The server ends as a program: static objects that it has constructed are destroyed.
    return argv == NULL ? 0 : program_main(argc, argv, environ);
}

// Called by the start code of each program, before the program's own constructors.
__attribute__((visibility("default"))) int __libc_start_main(Main main, int argc, char **argv,
                                                             void (*init)(void), void (*fini)(void),
                                                             void (*rtld_fini)(void),
                                                             void *stack_end)
{
    Start start = NULL;
    void *const found = dlsym(RTLD_NEXT, "__libc_start_main");
    const char *const socket = getenv(SOCKET_VARIABLE);
    if (found == NULL) {
        _exit(FAILED);
    }
    memcpy(&start, &found, sizeof start);
    if (socket != NULL) {
        char *point = NULL;
        const int descriptor = (int)strtol(socket, &point, 10);
        if (strcmp(point, ",main") != 0) {
            argv = serve(descriptor, &argc);
            if (argv == NULL) {
                _exit(0);
            }
        } else {
            // A program that a constructor starts must not become a server, too.
            fcntl(descriptor, F_SETFD, FD_CLOEXEC);
            unsetenv(SOCKET_VARIABLE);
            main_socket = descriptor;
            program_main = main;
            main = serve_main;
        }
    }
    return start(main, argc, argv, init, fini, rtld_fini, stack_end);
}
