// SPDX-License-Identifier: Apache-2.0
// Runs a step of a test or a fixture and reports its exception.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_ATTEMPT_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_ATTEMPT_H

#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <typeinfo>

#if defined(__GNUC__)
#include <cxxabi.h>
#endif

#include "../Exception.h"
#include "../TestResult.h"

namespace robottestingframework {
namespace internal {

// The type of the present exception.
inline std::string exception_type()
{
#if defined(__GNUC__)
    const std::type_info *type = abi::__cxa_current_exception_type();
    if (type != nullptr) {
        int status = 0;
        const std::unique_ptr<char, void (*)(void *)> name(
            abi::__cxa_demangle(type->name(), nullptr, nullptr, &status), std::free);
        return name ? name.get() : type->name();
    }
#endif
    return "unknown type";
}

// The text of the present exception.
inline TestMessage exception_message()
{
    try {
        throw;
    } catch (const Exception &exception) {
        return exception.message();
    } catch (const std::exception &exception) {
        return TestMessage(exception_type() + ": " + exception.what());
    } catch (...) {
        return TestMessage("exception of type " + exception_type());
    }
}

enum class Phase { test, tear_down };

// Whether the step returned. A failed assertion is a failure, but an error in the
// tear-down.
template <class Step>
bool attempt(const Test *test, TestResult &result, Phase phase, Step step)
{
    try {
        step();
        return true;
    } catch (const TestFailureException &exception) {
        if (phase == Phase::tear_down) {
            result.addError(test, exception.message());
        } else {
            result.addFailure(test, exception.message());
        }
    } catch (...) {
        result.addError(test, exception_message());
    }
    return false;
}

// Whether a step returned true. That it returned false is an error.
template <class Step>
bool succeeds(const Test *test, TestResult &result, Phase phase, const std::string &name, Step step)
{
    bool is_good = false;
    if (attempt(test, result, phase, [&] { is_good = step(); }) && !is_good) {
        result.addError(test, TestMessage(name + " returned false"));
    }
    return is_good;
}

} // namespace internal
} // namespace robottestingframework

#endif
