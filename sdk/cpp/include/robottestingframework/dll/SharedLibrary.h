// SPDX-License-Identifier: Apache-2.0
// A library that is loaded at run time.
#ifndef ROBOTTESTINGFRAMEWORK_SHAREDLIBRARY_H
#define ROBOTTESTINGFRAMEWORK_SHAREDLIBRARY_H

#include <string>

#include <dlfcn.h>

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
        handle_ = dlopen(filename, RTLD_NOW | RTLD_LOCAL);
        if (handle_ == nullptr) {
            keep_error();
        }
        return handle_ != nullptr;
    }

    bool close()
    {
        const bool closed = handle_ == nullptr || dlclose(handle_) == 0;
        handle_ = nullptr;
        return closed;
    }

    std::string error() { return error_; }

    // Null if it does not exist.
    void *getSymbol(const char *symbolName)
    {
        if (handle_ == nullptr) {
            return nullptr;
        }
        void *const symbol = dlsym(handle_, symbolName);
        if (symbol == nullptr) {
            keep_error();
        }
        return symbol;
    }

    bool isValid() const { return handle_ != nullptr; }

private:
    void keep_error()
    {
        const char *const words = dlerror();
        error_ = words == nullptr ? "" : words;
    }

    void *handle_ = nullptr;
    std::string error_;
};

} // namespace shlibpp

#endif
