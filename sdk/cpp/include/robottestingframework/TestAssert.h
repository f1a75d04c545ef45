// SPDX-License-Identifier: Apache-2.0
// Checks and assertions, with file and line. A message is a std::string or a
// literal. ASSERT ends the step with an exception; after TEST, which is for member
// functions of a test, the step continues.
#ifndef ROBOTTESTINGFRAMEWORK_TESTASSERT_H
#define ROBOTTESTINGFRAMEWORK_TESTASSERT_H

#include <string>

#include "Asserter.h"

// A warning of the compiler at this line.
#if defined(__GNUC__)
#define ROBOTTESTINGFRAMEWORK_INTERNAL_PRAGMA(x) _Pragma(#x)
#define ROBOTTESTINGFRAMEWORK_COMPILER_MESSAGE(x) ROBOTTESTINGFRAMEWORK_INTERNAL_PRAGMA(message #x)
#define ROBOTTESTINGFRAMEWORK_COMPILER_WARNING(x)                                                  \
    ROBOTTESTINGFRAMEWORK_INTERNAL_PRAGMA(GCC warning #x)
#define ROBOTTESTINGFRAMEWORK_COMPILER_ERROR(x) ROBOTTESTINGFRAMEWORK_INTERNAL_PRAGMA(GCC error #x)
#else
#define ROBOTTESTINGFRAMEWORK_COMPILER_MESSAGE(x)
#define ROBOTTESTINGFRAMEWORK_COMPILER_WARNING(x)
#define ROBOTTESTINGFRAMEWORK_COMPILER_ERROR(x)
#endif

#define ROBOTTESTINGFRAMEWORK_INTERNAL_SAID(how, message)                                          \
    (::robottestingframework::internal::said(how, message, ROBOTTESTINGFRAMEWORK_SOURCEFILE(),     \
                                             ROBOTTESTINGFRAMEWORK_SOURCELINE()))
#define ROBOTTESTINGFRAMEWORK_INTERNAL_TEST                                                        \
    (dynamic_cast<::robottestingframework::TestCase *>(this))

// A failure: the robot is wrong.
#define ROBOTTESTINGFRAMEWORK_ASSERT_FAIL(message)                                                 \
    (::robottestingframework::Asserter::fail(                                                      \
        ROBOTTESTINGFRAMEWORK_INTERNAL_SAID("assertion failed", message)))

// A failure when the condition is true.
#define ROBOTTESTINGFRAMEWORK_ASSERT_FAIL_IF_TRUE(condition, message)                              \
    (::robottestingframework::Asserter::fail(                                                      \
        !(condition),                                                                              \
        ROBOTTESTINGFRAMEWORK_INTERNAL_SAID("assertion failed, is true: " #condition, message)))

// A failure when the condition is false.
#define ROBOTTESTINGFRAMEWORK_ASSERT_FAIL_IF_FALSE(condition, message)                             \
    (::robottestingframework::Asserter::fail(                                                      \
        (condition),                                                                               \
        ROBOTTESTINGFRAMEWORK_INTERNAL_SAID("assertion failed, is false: " #condition, message)))

// An error: the bench is wrong.
#define ROBOTTESTINGFRAMEWORK_ASSERT_ERROR(message)                                                \
    (::robottestingframework::Asserter::error(                                                     \
        ROBOTTESTINGFRAMEWORK_INTERNAL_SAID("error", message)))

// An error when the condition is true.
#define ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_TRUE(condition, message)                             \
    (::robottestingframework::Asserter::error(                                                     \
        !(condition),                                                                              \
        ROBOTTESTINGFRAMEWORK_INTERNAL_SAID("error, is true: " #condition, message)))

// An error when the condition is false.
#define ROBOTTESTINGFRAMEWORK_ASSERT_ERROR_IF_FALSE(condition, message)                            \
    (::robottestingframework::Asserter::error(                                                     \
        (condition),                                                                               \
        ROBOTTESTINGFRAMEWORK_INTERNAL_SAID("error, is false: " #condition, message)))

// Information only.
#define ROBOTTESTINGFRAMEWORK_TEST_REPORT(message)                                                 \
    (::robottestingframework::Asserter::report(                                                    \
        ROBOTTESTINGFRAMEWORK_INTERNAL_SAID("reports", message),                                   \
        ROBOTTESTINGFRAMEWORK_INTERNAL_TEST))

// A failure when the condition is false; the test continues.
#define ROBOTTESTINGFRAMEWORK_TEST_FAIL_IF_FALSE(condition, message)                               \
    (::robottestingframework::Asserter::testFail(                                                  \
        (condition), ROBOTTESTINGFRAMEWORK_INTERNAL_SAID("is false: " #condition, message),        \
        ROBOTTESTINGFRAMEWORK_INTERNAL_TEST))

// A failure when the condition is true; the test continues.
#define ROBOTTESTINGFRAMEWORK_TEST_FAIL_IF_TRUE(condition, message)                                \
    (::robottestingframework::Asserter::testFail(                                                  \
        !(condition), ROBOTTESTINGFRAMEWORK_INTERNAL_SAID("is true: " #condition, message),        \
        ROBOTTESTINGFRAMEWORK_INTERNAL_TEST))

// A failure when the condition is false, else a check; the test continues.
#define ROBOTTESTINGFRAMEWORK_TEST_CHECK(condition, message)                                       \
    (::robottestingframework::Asserter::testCheck(                                                 \
        (condition), ROBOTTESTINGFRAMEWORK_INTERNAL_SAID("checks", message),                       \
        ROBOTTESTINGFRAMEWORK_INTERNAL_TEST))

#endif
