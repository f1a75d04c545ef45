// SPDX-License-Identifier: Apache-2.0
// Gives a program the environment that its user gave it: removes the library that rtf preloads.
// C and C++.
#ifndef RTF_PRELOAD_ENVIRONMENT_H
#define RTF_PRELOAD_ENVIRONMENT_H

#include <stdlib.h>
#include <string.h>

// Removes the first entry of a list that is separated with colons. The rest is the user's.
static void rtf_remove_first(const char *name)
{
    const char *const list = getenv(name);
    const char *const rest = list == NULL ? NULL : strchr(list, ':');
    if (rest == NULL) {
        unsetenv(name);
    } else {
        // A copy, because the new value is a part of the old one.
        char *const copy = strdup(rest + 1);
        if (copy != NULL) {
            setenv(name, copy, 1);
            free(copy);
        }
    }
}

// Undoes what the host has added to preload this library, so that programs which this one starts
// do not load it. See crates/rtf-frameworks/src/preload.rs.
static void rtf_restore_environment(const char *library)
{
    const char *const list = getenv("LD_PRELOAD");
    const char *const options = getenv("ASAN_OPTIONS");
    const char *const own = "verify_asan_link_order=0";
    const size_t first = list == NULL ? 0 : strcspn(list, ":");
    const size_t length = strlen(library);
    if (first < length || strncmp(list + first - length, library, length) != 0) {
        return;
    }
    rtf_remove_first("LD_PRELOAD");
    if (options != NULL && strncmp(options, own, strlen(own)) == 0) {
        rtf_remove_first("ASAN_OPTIONS");
    }
}

#endif
