// SPDX-License-Identifier: Apache-2.0
// Boost.Test with a file for its report crashes in `exit`, if a test calls it: its state uses the
// log, which was destroyed before. In a process that a test has forked, the static objects of its
// library stay. See "Descendants" in spec/frameworks.md.
#ifndef RTF_PRELOAD_BOOST_OBJECTS_H
#define RTF_PRELOAD_BOOST_OBJECTS_H

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

#define RTF_BOOST_LIBRARY "libboost_unit_test_framework"

typedef void (*RtfDestructor)(void *);
typedef int (*RtfRegister)(RtfDestructor, void *, void *);

// A static object of the library.
struct RtfBoostObject
{
    RtfDestructor destructor;
    void *object;
};

static int rtf_is_forked(void);

static void rtf_destroy_boost_object(void *registered)
{
    const struct RtfBoostObject object = *(struct RtfBoostObject *)registered;
    free(registered);
    if (!rtf_is_forked()) {
        object.destructor(object.object);
    }
}

// Whether the library has this handle.
static int rtf_is_boost(void *handle)
{
    static void *known;
    Dl_info info;
    if (handle == NULL || handle == known) {
        return handle != NULL;
    }
    if (dladdr(handle, &info) == 0 || info.dli_fname == NULL ||
        strstr(info.dli_fname, RTF_BOOST_LIBRARY) == NULL) {
        return 0;
    }
    known = handle;
    return 1;
}

// Registers the destructor of a static object: all of them, of the program and its libraries.
__attribute__((visibility("default"))) int __cxa_atexit(RtfDestructor destructor, void *object,
                                                        void *handle)
{
    static RtfRegister next;
    if (next == NULL) {
        void *const found = dlsym(RTLD_NEXT, "__cxa_atexit");
        if (found == NULL) {
            abort();
        }
        memcpy(&next, &found, sizeof next);
    }
    struct RtfBoostObject *const registered =
        rtf_is_boost(handle) ? malloc(sizeof *registered) : NULL;
    if (registered == NULL) {
        return next(destructor, object, handle);
    }
    registered->destructor = destructor;
    registered->object = object;
    return next(rtf_destroy_boost_object, registered, handle);
}

#endif
