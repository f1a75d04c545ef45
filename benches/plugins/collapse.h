/* The fixture writes its process id to a file, and the test that kills it reads the file.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef COLLAPSE_H
#define COLLAPSE_H

#include <stdio.h>

/* Returns 0 on success. */
static inline int write_pid(const char *path, long pid)
{
    FILE *file = fopen(path, "w");
    if (file == NULL) {
        return -1;
    }
    fprintf(file, "%ld\n", pid);
    return fclose(file);
}

/* Returns 0 if there is none. */
static inline long read_pid(const char *path)
{
    long pid = 0;
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        return 0;
    }
    if (fscanf(file, "%ld", &pid) != 1) {
        pid = 0;
    }
    fclose(file);
    return pid;
}

#endif
