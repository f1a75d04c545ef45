// SPDX-License-Identifier: Apache-2.0
// An object of a library, destroyed with this one.
#ifndef ROBOTTESTINGFRAMEWORK_SHAREDLIBRARYCLASS_H
#define ROBOTTESTINGFRAMEWORK_SHAREDLIBRARYCLASS_H

#include "SharedLibraryClassFactory.h"

namespace shlibpp {

template <class T>
class SharedLibraryClass
{
public:
    SharedLibraryClass() {}
    explicit SharedLibraryClass(SharedLibraryClassFactory<T> &factory) { open(factory); }
    virtual ~SharedLibraryClass() { SharedLibraryClass::close(); }
    SharedLibraryClass(const SharedLibraryClass &) = delete;
    SharedLibraryClass &operator=(const SharedLibraryClass &) = delete;

    bool open(SharedLibraryClassFactory<T> &factory)
    {
        close();
        object_ = factory.create();
        if (object_ != nullptr) {
            factory_ = &factory;
            factory.addRef();
        }
        return object_ != nullptr;
    }

    // The last object of a factory destroys the factory.
    virtual bool close()
    {
        if (object_ != nullptr) {
            factory_->destroy(object_);
            if (factory_->removeRef() == 0) {
                delete factory_;
            }
        }
        object_ = nullptr;
        factory_ = nullptr;
        return true;
    }

    T &getContent() { return *object_; }
    bool isValid() const { return object_ != nullptr; }
    T &operator*() { return *object_; }
    T *operator->() { return object_; }

private:
    T *object_ = nullptr;
    SharedLibraryClassFactory<T> *factory_ = nullptr;
};

} // namespace shlibpp

#endif
