// SPDX-License-Identifier: Apache-2.0
// An object of a plug-in that this program has loaded.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_LOADEDPLUGIN_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_LOADEDPLUGIN_H

#include <memory>
#include <string>

#include "../dll/SharedLibraryClassFactory.h"

namespace robottestingframework {
namespace internal {

template <class T>
class LoadedPlugin
{
public:
    LoadedPlugin() {}
    ~LoadedPlugin() { close(); }
    LoadedPlugin(const LoadedPlugin &) = delete;
    LoadedPlugin &operator=(const LoadedPlugin &) = delete;

    T *open(const std::string &filename, const char *factory_name)
    {
        close();
        error_.clear();
        factory_.reset(new Factory(filename.c_str(), factory_name));
        object_ = factory_->create();
        if (object_ == nullptr) {
            error_ = factory_->isValid()
                         ? "the plug-in could not be created"
                         : "cannot load plug-in " + filename + ": " + factory_->getError();
        }
        return object_;
    }

    void close()
    {
        if (object_ != nullptr) {
            factory_->destroy(object_);
        }
        object_ = nullptr;
        factory_.reset();
    }

    const std::string &error() const { return error_; }

private:
    using Factory = shlibpp::SharedLibraryClassFactory<T>;

    std::unique_ptr<Factory> factory_;
    T *object_ = nullptr;
    std::string error_;
};

} // namespace internal
} // namespace robottestingframework

#endif
