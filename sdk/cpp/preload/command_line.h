// SPDX-License-Identifier: Apache-2.0
// Sets the command line of this process in /proc. A program may execute itself again with it.
#ifndef RTF_PRELOAD_COMMAND_LINE_H
#define RTF_PRELOAD_COMMAND_LINE_H

#include <fcntl.h>
#include <linux/prctl.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

// Fields of /proc/self/stat after the name of the program, the first of which has the number 3.
enum {
    RTF_FIRST_FIELD = 3,
    RTF_START_CODE = 26,
    RTF_END_CODE = 27,
    RTF_START_STACK = 28,
    RTF_START_DATA = 45,
    RTF_END_DATA = 46,
    RTF_START_BRK = 47,
    RTF_ENV_START = 50,
    RTF_ENV_END = 51,
    RTF_FIELDS = 53
};

// Reads the fields; false if this is not possible.
static int rtf_read_fields(unsigned long long *fields)
{
    char text[2048];
    const int file = open("/proc/self/stat", O_RDONLY | O_CLOEXEC);
    const ssize_t length = file < 0 ? -1 : read(file, text, sizeof text - 1);
    close(file);
    if (length <= 0) {
        return 0;
    }
    text[length] = '\0';
    // The name may contain anything. The state after it is a letter.
    char *at = strrchr(text, ')');
    for (int field = RTF_FIRST_FIELD; at != NULL && field < RTF_FIELDS; ++field) {
        at = strchr(at + 1, ' ');
        fields[field] = at == NULL ? 0 : strtoull(at + 1, NULL, 10);
    }
    return at != NULL;
}

// The strings from `start` to `end`, which stay where they are, become the command line. Kernels
// without support for checkpoints keep the old one.
static void rtf_set_command_line(const char *start, const char *end)
{
    unsigned long long fields[RTF_FIELDS] = {0};
    if (!rtf_read_fields(fields)) {
        return;
    }
    struct prctl_mm_map map = {
        .start_code = fields[RTF_START_CODE],
        .end_code = fields[RTF_END_CODE],
        .start_data = fields[RTF_START_DATA],
        .end_data = fields[RTF_END_DATA],
        .start_brk = fields[RTF_START_BRK],
        .brk = (unsigned long)syscall(SYS_brk, 0),
        .start_stack = fields[RTF_START_STACK],
        .arg_start = (unsigned long)start,
        .arg_end = (unsigned long)end,
        .env_start = fields[RTF_ENV_START],
        .env_end = fields[RTF_ENV_END],
        .exe_fd = (unsigned)-1,
    };
    prctl(PR_SET_MM, PR_SET_MM_MAP, &map, sizeof map, 0);
}

#endif
