// SPDX-License-Identifier: Apache-2.0
// Parses a line of JSON from the runner.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_JSONFIELDS_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_JSONFIELDS_H

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <map>
#include <string>

namespace robottestingframework {
namespace internal {

// The strings and numbers of a JSON object by their paths: `message.location.line`.
// Without members of arrays. Expects valid JSON.
class JsonFields
{
public:
    explicit JsonFields(const std::string &line) : text_(line) { value(std::string()); }

    // Empty if there is no such field.
    const std::string &operator[](const std::string &path) { return fields_[path]; }

private:
    char here() const { return at_ < text_.size() ? text_[at_] : '\0'; }

    void skip_blanks()
    {
        while (here() == ' ' || here() == '\t') {
            ++at_;
        }
    }

    void value(const std::string &path)
    {
        skip_blanks();
        if (here() == '{') {
            members(path, '}');
        } else if (here() == '[') {
            members(path, ']');
        } else if (here() == '"') {
            fields_[path] = string();
        } else {
            const std::size_t begin = at_;
            at_ = std::min(text_.find_first_of(",]} ", at_), text_.size());
            fields_[path] = text_.substr(begin, at_ - begin);
        }
        skip_blanks();
    }

    void members(const std::string &path, char end)
    {
        do {
            ++at_; // the opening bracket, or a comma
            skip_blanks();
            if (here() == end) {
                break;
            }
            std::string own = "[]";
            if (end == '}') {
                own = string();
                skip_blanks();
                ++at_; // the colon
            }
            value(path.empty() ? own : path + "." + own);
        } while (here() == ',');
        ++at_;
    }

    std::string string()
    {
        std::string result;
        ++at_; // the quote
        while (at_ < text_.size() && here() != '"') {
            if (here() == '\\') {
                ++at_;
                result += escaped();
            } else {
                result += here();
            }
            ++at_;
        }
        ++at_;
        return result;
    }

    // The character of an escape sequence; moves at_ to the end of the sequence.
    std::string escaped()
    {
        const std::string from = "bfnrt";
        const std::size_t index = from.find(here());
        if (here() == 'u') {
            unsigned long code = hexadecimal();
            if (code >= 0xD800 && code < 0xDC00 && text_.compare(at_ + 1, 2, "\\u") == 0) {
                at_ += 2;
                code = 0x10000 + ((code - 0xD800) << 10) + (hexadecimal() - 0xDC00);
            }
            return utf8(code);
        }
        return std::string(1, index == std::string::npos ? here() : "\b\f\n\r\t"[index]);
    }

    unsigned long hexadecimal()
    {
        const unsigned long code = std::strtoul(text_.substr(at_ + 1, 4).c_str(), nullptr, 16);
        at_ += 4;
        return code;
    }

    static std::string utf8(unsigned long code)
    {
        const auto byte = [](unsigned long bits) { return static_cast<char>(bits); };
        std::string text;
        if (code < 0x80) {
            return std::string(1, byte(code));
        }
        if (code < 0x800) {
            text += byte(0xC0 | code >> 6);
        } else {
            if (code < 0x10000) {
                text += byte(0xE0 | code >> 12);
            } else {
                text += byte(0xF0 | code >> 18);
                text += byte(0x80 | (code >> 12 & 0x3F));
            }
            text += byte(0x80 | (code >> 6 & 0x3F));
        }
        return text + byte(0x80 | (code & 0x3F));
    }

    std::string text_;
    std::size_t at_ = 0;
    std::map<std::string, std::string> fields_;
};

} // namespace internal
} // namespace robottestingframework

#endif
