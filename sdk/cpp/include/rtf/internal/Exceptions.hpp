// SPDX-License-Identifier: Apache-2.0
// Reports exceptions that end a step or a case.
#ifndef RTF_INTERNAL_EXCEPTIONS_HPP
#define RTF_INTERNAL_EXCEPTIONS_HPP

#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <typeinfo>

#include <cxxabi.h>

#include <rtf/internal/Message.hpp>

namespace rtf {
namespace internal {

// The name of the present exception's type.
inline std::string exception_type()
{
    const std::type_info *type = abi::__cxa_current_exception_type();
    if (type == nullptr) {
        return "unknown type";
    }
    int status = 0;
    const std::unique_ptr<char, void (*)(void *)> name(
        abi::__cxa_demangle(type->name(), nullptr, nullptr, &status), std::free);
    return name ? name.get() : type->name();
}

// Reports an error without a location.
inline void report_error(const std::string &text)
{
    send(RTF_MESSAGE_ERROR, text, Location{nullptr, 0});
}

// Reports the present exception as an error. Returns whether it ends the test.
inline bool report_exception()
{
    try {
        throw;
    } catch (const Stop &stop) {
        return stop.ends_test;
    } catch (const std::exception &exception) {
        report_error(exception_type() + ": " + exception.what());
    } catch (...) {
        report_error("exception of type " + exception_type());
    }
    return false;
}

} // namespace internal
} // namespace rtf

#endif
