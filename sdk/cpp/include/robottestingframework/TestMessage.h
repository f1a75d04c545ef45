// SPDX-License-Identifier: Apache-2.0
// A message of a test, a suite or a fixture, with its detail and location.
#ifndef ROBOTTESTINGFRAMEWORK_TESTMESSAGE_H
#define ROBOTTESTINGFRAMEWORK_TESTMESSAGE_H

#include <string>

#define ROBOTTESTINGFRAMEWORK_SOURCELINE() __LINE__
#define ROBOTTESTINGFRAMEWORK_SOURCEFILE() __FILE__

namespace robottestingframework {

class TestMessage;

namespace internal {
TestMessage said(const std::string &how, const std::string &text, const char *file, int line);
TestMessage as_check(const TestMessage &message);
bool is_check(const TestMessage &message);
std::string text_of(const TestMessage &message);
} // namespace internal

class TestMessage
{
public:
    TestMessage() {}
    TestMessage(const char *msg) : message_(msg) {}
    TestMessage(const std::string msg) : message_(msg) {}
    TestMessage(const std::string msg, const std::string filename, unsigned int line)
        : line_(line), file_(filename), message_(msg)
    {
    }
    TestMessage(const std::string msg, const std::string detail, const std::string filename = "",
                unsigned int line = 0)
        : line_(line), file_(filename), message_(msg), detail_(detail)
    {
    }
    TestMessage(const TestMessage &) = default;
    TestMessage &operator=(const TestMessage &) = default;
    virtual ~TestMessage() {}

    void setMessage(const std::string message) { message_ = message; }
    void setDetail(const std::string detail) { detail_ = detail; }
    std::string getMessage() const { return message_; }
    std::string getDetail() const { return detail_; }

    void setSourceLineNumber(unsigned int line) { line_ = line; }
    unsigned int getSourceLineNumber() const { return line_; }
    void setSourceFileName(const std::string filename) { file_ = filename; }
    std::string getSourceFileName() const { return file_; }

    void clear() { *this = TestMessage(); }

private:
    friend TestMessage internal::said(const std::string &, const std::string &, const char *, int);
    friend TestMessage internal::as_check(const TestMessage &);
    friend bool internal::is_check(const TestMessage &);
    friend std::string internal::text_of(const TestMessage &);

    unsigned int line_ = 0;
    std::string file_;
    std::string message_;
    std::string detail_;
    // Whether the message is a macro's text, and the detail the user's.
    bool is_macro_ = false;
    // Whether a report is about a check that holds.
    bool is_check_ = false;
};

namespace internal {

// A macro's message: its own text, and the user's as the detail.
inline TestMessage said(const std::string &how, const std::string &text, const char *file, int line)
{
    TestMessage message(how, text, file, static_cast<unsigned int>(line));
    message.is_macro_ = true;
    return message;
}

inline TestMessage as_check(const TestMessage &message)
{
    TestMessage check(message);
    check.is_check_ = true;
    return check;
}

inline bool is_check(const TestMessage &message)
{
    return message.is_check_;
}

// The message as one line.
inline std::string text_of(const TestMessage &message)
{
    if (message.detail_.empty()) {
        return message.message_;
    }
    if (message.is_macro_ || message.message_.empty()) {
        return message.detail_;
    }
    return message.message_ + ": " + message.detail_;
}

} // namespace internal
} // namespace robottestingframework

#endif
