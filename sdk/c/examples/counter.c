/* A test in plain C99: counts to the number that the suite gives, and measures
 * how long that takes in steps.
 *
 * cc -std=c99 -shared -fPIC -I<include> counter.c -o counter.so
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include <rtf/plugin.h>

typedef struct counter
{
    const rtf_host *host;
    long goal;
} counter;

static void say(const counter *self, int32_t kind, const char *text, uint32_t line)
{
    rtf_message message = {0};
    message.size = sizeof message;
    message.kind = kind;
    message.text = rtf_string(text);
    message.file = __FILE__;
    message.line = line;
    self->host->message(self->host->context, &message);
}

static void *create(const rtf_host *host)
{
    counter *self = calloc(1, sizeof *self);
    if (self != NULL) {
        self->host = host;
    }
    return self;
}

static void destroy(void *self)
{
    free(self);
}

static int32_t setup(void *plugin, int argc, char **argv)
{
    counter *self = plugin;
    if (argc != 2) {
        say(self, RTF_MESSAGE_ERROR, "expected one argument: the number to count to", __LINE__);
        return RTF_STOPPED;
    }
    self->goal = strtol(argv[1], NULL, 10);
    return self->goal > 0 ? RTF_DONE : RTF_REFUSED;
}

static int32_t run(void *plugin)
{
    const counter *self = plugin;
    const double most = 1000;
    long count = 0;
    while (count < self->goal) {
        if (self->host->interrupted(self->host->context)) {
            return RTF_STOPPED;
        }
        ++count;
    }
    rtf_measurement steps = {0};
    steps.size = sizeof steps;
    steps.name = rtf_string("steps");
    steps.value = (double)count;
    steps.high = &most;
    steps.file = __FILE__;
    steps.line = __LINE__;
    self->host->measure(self->host->context, &steps);
    say(self, count == self->goal ? RTF_MESSAGE_CHECK : RTF_MESSAGE_FAILURE, "counted to the goal",
        __LINE__);
    return RTF_DONE;
}

const rtf_plugin_table *rtf_plugin(void)
{
    static const rtf_plugin_table table = {
        .abi_major = RTF_ABI_MAJOR,
        .abi_minor = RTF_ABI_MINOR,
        .size = sizeof table,
        .kind = RTF_KIND_TEST,
        .name = "counter",
        .create = create,
        .destroy = destroy,
        .setup = setup,
        .run = run,
    };
    return &table;
}
