// SPDX-License-Identifier: Apache-2.0
// Exceptions that end a test, a suite or a fixture.
#ifndef ROBOTTESTINGFRAMEWORK_EXCEPTION_H
#define ROBOTTESTINGFRAMEWORK_EXCEPTION_H

#include <exception>
#include <string>

#include "TestMessage.h"

namespace robottestingframework {

class Exception : public std::exception
{
public:
    Exception(const TestMessage &msg) : message_(msg), what_(internal::text_of(msg)) {}

    const char *what() const noexcept override { return what_.c_str(); }
    const TestMessage &message() const { return message_; }

private:
    TestMessage message_;
    std::string what_;
};

// The robot is wrong.
class TestFailureException : public Exception
{
public:
    TestFailureException(const TestMessage &msg) : Exception(msg) {}
};

// The bench is wrong.
class TestErrorException : public Exception
{
public:
    TestErrorException(const TestMessage &msg) : Exception(msg) {}
};

// A fixture cannot be set up or torn down.
class FixtureException : public Exception
{
public:
    FixtureException(const TestMessage &msg) : Exception(msg) {}
};

} // namespace robottestingframework

#endif
