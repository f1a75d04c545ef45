// SPDX-License-Identifier: Apache-2.0
// A factory whose objects have a known type.
#ifndef ROBOTTESTINGFRAMEWORK_SHAREDLIBRARYCLASSFACTORY_H
#define ROBOTTESTINGFRAMEWORK_SHAREDLIBRARYCLASSFACTORY_H

#include "SharedLibraryFactory.h"

namespace shlibpp {

template <class T>
class SharedLibraryClassFactory : public SharedLibraryFactory
{
public:
    SharedLibraryClassFactory() {}
    explicit SharedLibraryClassFactory(const char *dll_name, const char *fn_name = nullptr)
        : SharedLibraryFactory(dll_name, fn_name)
    {
    }

    // Null if the factory is invalid, or could not create an object.
    T *create() { return isValid() ? static_cast<T *>(getApi().create()) : nullptr; }

    void destroy(T *object)
    {
        if (isValid() && object != nullptr) {
            getApi().destroy(object);
        }
    }
};

} // namespace shlibpp

#endif
