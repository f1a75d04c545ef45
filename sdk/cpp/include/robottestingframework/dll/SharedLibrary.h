// SPDX-License-Identifier: Apache-2.0
// A library that is loaded at run time.
#ifndef ROBOTTESTINGFRAMEWORK_SHAREDLIBRARY_H
#define ROBOTTESTINGFRAMEWORK_SHAREDLIBRARY_H

#include <string>

#if defined(_WIN32)
#include <windows.h>
#else
#include <dlfcn.h>
#endif

namespace shlibpp {

class SharedLibrary
{
public:
    SharedLibrary() {}
    explicit SharedLibrary(const char *filename) { open(filename); }
    virtual ~SharedLibrary() { close(); }
    SharedLibrary(const SharedLibrary &) = delete;
    SharedLibrary &operator=(const SharedLibrary &) = delete;

    // False: error() has the reason.
    bool open(const char *filename)
    {
        close();
        error_.clear();
#if defined(_WIN32)
        handle_ = reinterpret_cast<void *>(LoadLibraryA(filename));
        if (handle_ == nullptr) {
            error_ = "error " + std::to_string(GetLastError());
        }
#else
        handle_ = dlopen(filename, RTLD_NOW | RTLD_LOCAL);
        if (handle_ == nullptr) {
            keep_error();
        }
#endif
        return handle_ != nullptr;
    }

    bool close()
    {
        bool closed = true;
        if (handle_ != nullptr) {
#if defined(_WIN32)
            closed = FreeLibrary(reinterpret_cast<HMODULE>(handle_)) != 0;
#else
            closed = dlclose(handle_) == 0;
#endif
        }
        handle_ = nullptr;
        return closed;
    }

    std::string error()
    {
        return error_;
    }

    // Null if it does not exist.
    void *getSymbol(const char *symbolName)
    {
        if (handle_ == nullptr) {
            return nullptr;
        }
#if defined(_WIN32)
        return reinterpret_cast<void *>(
            GetProcAddress(reinterpret_cast<HMODULE>(handle_), symbolName));
#else
        void *const symbol = dlsym(handle_, symbolName);
        if (symbol == nullptr) {
            keep_error();
        }
        return symbol;
#endif
    }

    bool isValid() const
    {
        return handle_ != nullptr;
    }

private:
#if !defined(_WIN32)
    void keep_error()
    {
        const char *const words = dlerror();
        error_ = words == nullptr ? "" : words;
    }
#endif

    void *handle_ = nullptr;
    std::string error_;
};

} // namespace shlibpp

#endif
