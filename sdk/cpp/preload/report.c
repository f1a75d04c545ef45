// SPDX-License-Identifier: Apache-2.0
// librtf-report.so: rtf preloads it (LD_PRELOAD) into programs that write the report of their
// framework to a file or a socket. Only one process has the report: the first one that opens it.
// Its descendants, which may be the same program with the same arguments, write to /dev/null.
// See "Descendants" in spec/frameworks.md.
//
// It uses the C library only, because the program may not contain C++.
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <netinet/in.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "boost_objects.h"
#include "environment.h"

#define EXPORTED __attribute__((visibility("default")))

// `PORT:DIRECTORY`: a port on the loopback interface, or 0, and the directory of the files.
#define REPORT_VARIABLE "RTF_REPORT"

// Next to the directory, which is a symbolic link: what it contains for the process that has the
// report, and the link that replaces it for all others.
#define OPEN_SUFFIX ".open"
#define TAKEN_SUFFIX ".taken"

// How many descriptors a program can have for its report.
enum { MAX_DESCRIPTORS = 8 };

typedef FILE *(*Open)(const char *, const char *);
typedef int (*Connect)(int, const struct sockaddr *, socklen_t);

// The process that has the report, its directory and its descriptors.
static pid_t owner;
static char directory[PATH_MAX];
static int descriptors[MAX_DESCRIPTORS];
static int descriptor_count;

static int rtf_is_forked(void)
{
    return owner != 0 && owner != getpid();
}

// Called in a process that was forked: nothing that it writes belongs to the report, neither what
// is in its buffers.
static void leave_report(void)
{
    const int saved = errno;
    const int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
    for (int index = 0; null >= 0 && index < descriptor_count; ++index) {
        if (fcntl(descriptors[index], F_GETFD) >= 0) {
            dup3(null, descriptors[index], O_CLOEXEC);
        }
    }
    close(null);
    errno = saved;
}

static void remember(int descriptor)
{
    fcntl(descriptor, F_SETFD, FD_CLOEXEC);
    if (descriptor_count < MAX_DESCRIPTORS) {
        descriptors[descriptor_count++] = descriptor;
    }
}

// Takes the report, if no process has it. The other ones find closed files. None of them needs the
// library in the programs that it starts.
static int take_report(const char *wanted)
{
    char taken[PATH_MAX];
    const int length = snprintf(taken, sizeof taken, "%s" TAKEN_SUFFIX, wanted);
    if (length < 0 || (size_t)length >= sizeof taken) {
        return 0;
    }
    strcpy(directory, wanted);
    unsetenv(REPORT_VARIABLE);
    rtf_restore_environment("librtf-report.so");
    if (rename(taken, directory) != 0) {
        return 0;
    }
    owner = getpid();
    pthread_atfork(NULL, NULL, leave_report);
    return 1;
}

// The value of the variable, and its port; null without a report that this process may take.
static const char *offered_directory(long *port)
{
    const char *const variable = owner == 0 ? getenv(REPORT_VARIABLE) : NULL;
    char *end = NULL;
    if (variable == NULL) {
        return NULL;
    }
    *port = strtol(variable, &end, 10);
    return *end == ':' ? end + 1 : NULL;
}

// Whether the path is in the directory.
static int is_in(const char *parent, const char *path)
{
    const size_t length = strlen(parent);
    return strncmp(path, parent, length) == 0 && path[length] == '/';
}

// The path under which this process finds a file.
static const char *own_path(const char *path, char *buffer)
{
    long port = 0;
    const char *const offered = offered_directory(&port);
    const int saved = errno;
    const int takes = offered != NULL && is_in(offered, path) && take_report(offered);
    errno = saved;
    if (!takes && (owner == 0 || rtf_is_forked() || !is_in(directory, path))) {
        return path;
    }
    const int length =
        snprintf(buffer, PATH_MAX, "%s" OPEN_SUFFIX "%s", directory, path + strlen(directory));
    return length > 0 && length < PATH_MAX ? buffer : path;
}

// Closes the descriptor to which a file is a link, in programs that this one executes.
static void close_link(const char *path)
{
    char target[64];
    const ssize_t length = readlink(path, target, sizeof target - 1);
    const char *const start = "/dev/fd/";
    if (length > 0) {
        target[length] = '\0';
        if (strncmp(target, start, strlen(start)) == 0) {
            fcntl((int)strtol(target + strlen(start), NULL, 10), F_SETFD, FD_CLOEXEC);
        }
    }
}

static int is_loopback(const struct sockaddr *address, socklen_t length, long port)
{
    struct sockaddr_in internet;
    if (port == 0 || address == NULL || length < sizeof internet || address->sa_family != AF_INET) {
        return 0;
    }
    memcpy(&internet, address, sizeof internet);
    return internet.sin_addr.s_addr == htonl(INADDR_LOOPBACK) && ntohs(internet.sin_port) == port;
}

static void *next_function(const char *name)
{
    void *const found = dlsym(RTLD_NEXT, name);
    if (found == NULL) {
        abort();
    }
    return found;
}

static FILE *open_file(const char *function, const char *path, const char *mode)
{
    Open next = NULL;
    void *const found = next_function(function);
    char buffer[PATH_MAX];
    const char *const own = path == NULL ? NULL : own_path(path, buffer);
    memcpy(&next, &found, sizeof next);
    FILE *const file = next(own, mode);
    if (file != NULL && own != path) {
        const int saved = errno;
        remember(fileno(file));
        close_link(own);
        errno = saved;
    }
    return file;
}

EXPORTED FILE *fopen(const char *path, const char *mode)
{
    return open_file("fopen", path, mode);
}

EXPORTED FILE *fopen64(const char *path, const char *mode)
{
    return open_file("fopen64", path, mode);
}

// With _GNU_SOURCE, the C library declares a union of pointers to all kinds of addresses.
EXPORTED int connect(int descriptor, __CONST_SOCKADDR_ARG any_address, socklen_t length)
{
    const struct sockaddr *const address = any_address.__sockaddr__;
    Connect next = NULL;
    void *const found = next_function("connect");
    long port = 0;
    const char *const offered = offered_directory(&port);
    memcpy(&next, &found, sizeof next);
    const int saved = errno;
    if (offered != NULL && is_loopback(address, length, port) && take_report(offered)) {
        remember(descriptor);
    }
    errno = saved;
    return next(descriptor, address, length);
}
