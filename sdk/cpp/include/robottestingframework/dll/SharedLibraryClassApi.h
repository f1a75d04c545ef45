// SPDX-License-Identifier: Apache-2.0
// The export of a C++ class from a library: a function, the factory, fills in a structure
// of functions. Both sides must be built with these headers; the structure differs from
// that of robot-testing-framework 2.x in its size.
#ifndef ROBOTTESTINGFRAMEWORK_SHAREDLIBRARYCLASSAPI_H
#define ROBOTTESTINGFRAMEWORK_SHAREDLIBRARYCLASSAPI_H

#include <cstring>

#include "Vocab.h"
#include "robottestingframework_dll_config.h"

namespace shlibpp {

struct SharedLibraryClassApi
{
    int startCheck;
    int structureSize;
    int systemVersion;
    void *(*create)();
    void (*destroy)(void *obj);
    int (*getVersion)(char *ver, int len);
    int (*getAbi)(char *abi, int len);
    int (*getClassName)(char *name, int len);
    int (*getBaseClassName)(char *name, int len);
    void *roomToGrow[32];
    int endCheck;
};

namespace internal {

constexpr int start_check = VOCAB('S', 'H', 'P', 'P');
constexpr int end_check = VOCAB('P', 'L', 'U', 'G');
constexpr int system_version = 100;

inline int copy_name(const char *name, char *to, int length)
{
    if (length > 0) {
        std::strncpy(to, name, static_cast<std::size_t>(length) - 1);
        to[length - 1] = '\0';
    }
    return static_cast<int>(std::strlen(name)) + 1;
}

template <class Class, class Base>
struct Maker
{
    static void *create()
    {
        try {
            return static_cast<Base *>(new Class);
        } catch (...) {
            return nullptr;
        }
    }
    static void destroy(void *object) { delete static_cast<Base *>(object); }
    static int nothing(char *, int) { return 0; }

    // Returns a number that only a complete structure has.
    static int fill(void *to, int length, int (*name)(char *, int), int (*base)(char *, int))
    {
        if (to == nullptr || length != static_cast<int>(sizeof(SharedLibraryClassApi))) {
            return -1;
        }
        SharedLibraryClassApi api = SharedLibraryClassApi();
        api.startCheck = start_check;
        api.structureSize = static_cast<int>(sizeof api);
        api.systemVersion = system_version;
        api.create = create;
        api.destroy = destroy;
        api.getVersion = nothing;
        api.getAbi = nothing;
        api.getClassName = name;
        api.getBaseClassName = base;
        api.endCheck = end_check;
        std::memcpy(to, &api, sizeof api);
        return api.startCheck;
    }
};

} // namespace internal
} // namespace shlibpp

#define SHLIBPP_SHARED_CLASS_FN extern "C" SHLIBPP_EXPORT

#define SHLIBPP_DEFAULT_FACTORY_NAME "shlibpp_default_factory"

// A factory with that name, which creates `classname`s as `basename`s.
#define SHLIBPP_DEFINE_SHARED_SUBCLASS(factoryname, classname, basename)                           \
    SHLIBPP_SHARED_CLASS_FN int factoryname(void *api, int len)                                    \
    {                                                                                              \
        return ::shlibpp::internal::Maker<classname, basename>::fill(                              \
            api, len,                                                                              \
            [](char *name, int room) {                                                             \
                return ::shlibpp::internal::copy_name(#classname, name, room);                     \
            },                                                                                     \
            [](char *name, int room) {                                                             \
                return ::shlibpp::internal::copy_name(#basename, name, room);                      \
            });                                                                                    \
    }

#define SHLIBPP_DEFINE_SHARED_CLASS(factoryname, classname)                                        \
    SHLIBPP_DEFINE_SHARED_SUBCLASS(factoryname, classname, classname)

#define SHLIBPP_DEFINE_DEFAULT_SHARED_CLASS(classname)                                             \
    SHLIBPP_DEFINE_SHARED_SUBCLASS(shlibpp_default_factory, classname, classname)

#endif
