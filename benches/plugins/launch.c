/* Measures a command: starts it COUNT times, one after the other, with posix_spawn, and
 * waits for each process.
 *
 *     launch COUNT RESULT COMMAND [ARGUMENT…]
 *
 * RESULT gets a line with the nanoseconds of the whole loop, then a line for each process:
 * nanoseconds, the largest resident set in KiB of the process or of one that it waited for,
 * wait status. This program must be small, because Linux includes the parent's resident set
 * before the exec.
 * SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE
#include <errno.h>
#include <spawn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>

extern char **environ;

typedef struct child
{
    int64_t nanoseconds;
    long rss_kib;
    int status;
} child;

static int64_t now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (int64_t)time.tv_sec * 1000000000 + time.tv_nsec;
}

static void give_up(const char *what, int number)
{
    fprintf(stderr, "launch: %s: %s\n", what, strerror(number));
    exit(125);
}

static child launch(char **command)
{
    child result = {0};
    struct rusage usage;
    pid_t pid = 0;
    const int64_t start = now();
    const int problem = posix_spawnp(&pid, command[0], NULL, NULL, command, environ);
    if (problem != 0) {
        give_up(command[0], problem);
    }
    while (wait4(pid, &result.status, 0, &usage) < 0) {
        if (errno != EINTR) {
            give_up("wait4", errno);
        }
    }
    result.nanoseconds = now() - start;
    result.rss_kib = usage.ru_maxrss;
    return result;
}

int main(int argc, char **argv)
{
    const long count = argc > 3 ? strtol(argv[1], NULL, 10) : 0;
    if (count < 1) {
        fputs("usage: launch COUNT RESULT COMMAND [ARGUMENT...]\n", stderr);
        return 125;
    }
    child *children = calloc((size_t)count, sizeof *children);
    FILE *file = fopen(argv[2], "we");
    if (children == NULL || file == NULL) {
        give_up(argv[2], errno);
    }

    const int64_t start = now();
    for (long index = 0; index < count; ++index) {
        children[index] = launch(argv + 3);
    }
    fprintf(file, "%lld\n", (long long)(now() - start));

    for (long index = 0; index < count; ++index) {
        fprintf(file, "%lld %ld %d\n", (long long)children[index].nanoseconds,
                children[index].rss_kib, children[index].status);
    }
    if (fclose(file) != 0) {
        give_up(argv[2], errno);
    }
    free(children);
    return 0;
}
