/* Kills the fixture and measures the time until the test is asked to stop, with one clock in
 * one process. It is in C, because it must measure after it was asked to stop.
 * SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE
#include <signal.h>
#include <stdlib.h>
#include <sys/types.h>
#include <time.h>

#include <rtf/plugin.h>

#include "collapse.h"

typedef struct killer
{
    const rtf_host *host;
    pid_t victim;
} killer;

static void *create(const rtf_host *host)
{
    killer *self = calloc(1, sizeof *self);
    if (self != NULL) {
        self->host = host;
    }
    return self;
}

static void destroy(void *self)
{
    free(self);
}

static double now_ms(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec * 1e3 + (double)time.tv_nsec / 1e6;
}

static int32_t setup(void *plugin, int argc, char **argv)
{
    killer *self = plugin;
    self->victim = argc == 2 ? (pid_t)read_pid(argv[1]) : 0;
    return self->victim > 1 ? RTF_DONE : RTF_REFUSED;
}

static int32_t run(void *plugin)
{
    const killer *self = plugin;
    const rtf_host *host = self->host;
    const double start = now_ms();
    if (kill(self->victim, SIGKILL) != 0) {
        return RTF_REFUSED;
    }
    if (!host->wait(host->context, 10)) {
        return RTF_REFUSED;
    }
    rtf_measurement latency = {0};
    latency.size = sizeof latency;
    latency.name = rtf_string("latency");
    latency.unit = rtf_string("ms");
    latency.value = now_ms() - start;
    latency.file = __FILE__;
    latency.line = __LINE__;
    host->measure(host->context, &latency);
    return RTF_STOPPED;
}

const rtf_plugin_table *rtf_plugin(void)
{
    static const rtf_plugin_table table = {
        .abi_major = RTF_ABI_MAJOR,
        .abi_minor = RTF_ABI_MINOR,
        .size = sizeof table,
        .kind = RTF_KIND_TEST,
        .name = "killer",
        .create = create,
        .destroy = destroy,
        .setup = setup,
        .run = run,
    };
    return &table;
}
