// SPDX-License-Identifier: Apache-2.0
// Opens a library and gets its factory's functions.
#ifndef ROBOTTESTINGFRAMEWORK_SHAREDLIBRARYFACTORY_H
#define ROBOTTESTINGFRAMEWORK_SHAREDLIBRARYFACTORY_H

#include <string>

#include "SharedLibrary.h"
#include "SharedLibraryClassApi.h"
#include "Vocab.h"

namespace shlibpp {

class SharedLibraryFactory
{
public:
    enum {
        STATUS_NONE,
        STATUS_OK = VOCAB('o', 'k'),
        STATUS_LIBRARY_NOT_FOUND = VOCAB('f', 'o', 'u', 'n'),
        STATUS_LIBRARY_NOT_LOADED = VOCAB('l', 'o', 'a', 'd'),
        STATUS_FACTORY_NOT_FOUND = VOCAB('f', 'a', 'c', 't'),
        STATUS_FACTORY_NOT_FUNCTIONAL = VOCAB('r', 'u', 'n')
    };

    SharedLibraryFactory() {}
    explicit SharedLibraryFactory(const char *dll_name, const char *fn_name = nullptr)
    {
        open(dll_name, fn_name);
    }
    virtual ~SharedLibraryFactory() {}
    SharedLibraryFactory(const SharedLibraryFactory &) = delete;
    SharedLibraryFactory &operator=(const SharedLibraryFactory &) = delete;

    // False: status and error have the reason.
    bool open(const char *dll_name, const char *fn_name = nullptr)
    {
        forget();
        name_ = dll_name;
        if (!library_.open(dll_name)) {
            return fails(STATUS_LIBRARY_NOT_FOUND, library_.error());
        }
        const char *const symbol = fn_name == nullptr ? SHLIBPP_DEFAULT_FACTORY_NAME : fn_name;
        void *const factory = library_.getSymbol(symbol);
        if (factory == nullptr) {
            return fails(STATUS_FACTORY_NOT_FOUND, library_.error());
        }
        if (!useFactoryFunction(factory)) {
            return fails(STATUS_FACTORY_NOT_FUNCTIONAL,
                         name_ + ": was built for another version: build it again");
        }
        return true;
    }

    bool isValid() const { return status_ == STATUS_OK; }
    int getStatus() const { return status_; }
    std::string getError() const { return error_; }
    const SharedLibraryClassApi &getApi() const { return api_; }

    int getReferenceCount() const { return references_; }
    int addRef() { return ++references_; }
    int removeRef() { return --references_; }

    // The library's file.
    std::string getName() const { return name_; }
    std::string getClassName() const { return class_; }
    std::string getBaseClassName() const { return base_; }

    // Uses a factory of this program.
    bool useFactoryFunction(void *factory)
    {
        const auto fill = reinterpret_cast<int (*)(void *, int)>(factory);
        api_ = SharedLibraryClassApi();
        const int size = static_cast<int>(sizeof api_);
        if (fill == nullptr || fill(&api_, size) != internal::start_check ||
            api_.structureSize != size || api_.systemVersion != internal::system_version ||
            api_.endCheck != internal::end_check) {
            api_ = SharedLibraryClassApi();
            return fails(STATUS_FACTORY_NOT_FUNCTIONAL, "the factory does not fit");
        }
        class_ = ask(api_.getClassName);
        base_ = ask(api_.getBaseClassName);
        status_ = STATUS_OK;
        error_.clear();
        return true;
    }

private:
    static std::string ask(int (*get)(char *, int))
    {
        char name[256] = "";
        get(name, static_cast<int>(sizeof name));
        return name;
    }

    void forget()
    {
        status_ = STATUS_NONE;
        class_.clear();
        base_.clear();
        error_.clear();
    }

    bool fails(int status, const std::string &error)
    {
        status_ = status;
        error_ = error;
        return false;
    }

    SharedLibrary library_;
    int status_ = STATUS_NONE;
    SharedLibraryClassApi api_ = SharedLibraryClassApi();
    int references_ = 1;
    std::string name_;
    std::string class_;
    std::string base_;
    std::string error_;
};

} // namespace shlibpp

#endif
