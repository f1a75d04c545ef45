// SPDX-License-Identifier: Apache-2.0
// JSON of the packets that session.hpp sends and receives. C++11.
#ifndef RTF_INTERNAL_SESSIONJSON_HPP
#define RTF_INTERNAL_SESSIONJSON_HPP

#include <cstddef>
#include <cstdlib>
#include <limits>
#include <locale>
#include <sstream>
#include <string>

namespace rtf {
namespace internal {
namespace session {

// The length of the valid UTF-8 sequence at `at`; 0 if it is invalid.
inline std::size_t utf8_length(const std::string &text, std::size_t at)
{
    const auto byte = [&text](std::size_t index) -> unsigned {
        return index < text.size() ? static_cast<unsigned char>(text[index]) : 0U;
    };
    const auto is_between = [&byte](std::size_t index, unsigned low, unsigned high) {
        return byte(index) >= low && byte(index) <= high;
    };
    const auto continues = [&is_between](std::size_t index) {
        return is_between(index, 0x80, 0xBF);
    };
    const unsigned first = byte(at);
    if (first < 0x80) {
        return 1;
    }
    if (first >= 0xC2 && first <= 0xDF) {
        return continues(at + 1) ? 2 : 0;
    }
    if (first >= 0xE0 && first <= 0xEF) {
        // Neither overlong sequences nor surrogates.
        const unsigned low = first == 0xE0 ? 0xA0 : 0x80;
        const unsigned high = first == 0xED ? 0x9F : 0xBF;
        return is_between(at + 1, low, high) && continues(at + 2) ? 3 : 0;
    }
    if (first >= 0xF0 && first <= 0xF4) {
        const unsigned low = first == 0xF0 ? 0x90 : 0x80;
        const unsigned high = first == 0xF4 ? 0x8F : 0xBF;
        return is_between(at + 1, low, high) && continues(at + 2) && continues(at + 3) ? 4 : 0;
    }
    return 0;
}

// The character at `at` in a JSON string; moves `at` behind it. A byte that is not UTF-8 is
// replaced.
inline std::string json_character(const std::string &text, std::size_t &at)
{
    const std::size_t length = utf8_length(text, at);
    if (length == 0) {
        ++at;
        return "\xEF\xBF\xBD";
    }
    const std::string character = text.substr(at, length);
    at += length;
    const unsigned code = static_cast<unsigned char>(character[0]);
    if (character == "\"" || character == "\\") {
        return "\\" + character;
    }
    if (code >= 0x20) {
        return character;
    }
    const char *const digits = "0123456789abcdef";
    return std::string("\\u00") + digits[code >> 4U] + digits[code & 15U];
}

inline std::string json_string(const std::string &text)
{
    std::string json = "\"";
    for (std::size_t at = 0; at < text.size();) {
        json += json_character(text, at);
    }
    return json + "\"";
}

// With all digits, independent of the locale of the program. `null` if it is not finite.
inline std::string json_number(double value)
{
    const double infinity = std::numeric_limits<double>::infinity();
    if (!(value > -infinity && value < infinity)) {
        return "null";
    }
    std::ostringstream stream;
    stream.imbue(std::locale::classic());
    stream.precision(std::numeric_limits<double>::max_digits10);
    stream << value;
    return stream.str();
}

// Reads the packets of the host, which are valid JSON without blanks.
class JsonReader
{
public:
    explicit JsonReader(const std::string &json) : json_(json) {}

    // Moves behind `character`, if it is next.
    bool skip(char character)
    {
        const bool is_next = at_ < json_.size() && json_[at_] == character;
        at_ += is_next ? 1 : 0;
        return is_next;
    }

    // Moves behind the next value, and returns it: a string as its text, any other value as
    // its JSON.
    std::string value()
    {
        const std::size_t start = at_;
        if (skip('"')) {
            return text();
        }
        for (std::size_t depth = 0; at_ < json_.size();) {
            const char next = json_[at_];
            if (next == '"') {
                ++at_;
                text();
                continue;
            }
            if (depth == 0 && (next == ',' || next == ']' || next == '}')) {
                break;
            }
            depth += next == '[' || next == '{' ? 1 : 0;
            depth -= next == ']' || next == '}' ? 1 : 0;
            ++at_;
        }
        return json_.substr(start, at_ - start);
    }

private:
    // The rest of a string.
    std::string text()
    {
        std::string found;
        while (at_ < json_.size() && !skip('"')) {
            if (skip('\\')) {
                append_escaped(found);
            } else {
                found += json_[at_++];
            }
        }
        return found;
    }

    void append_escaped(std::string &found)
    {
        const std::string letters = "bfnrt";
        const char kind = at_ < json_.size() ? json_[at_++] : '\0';
        const std::size_t index = letters.find(kind);
        if (kind == 'u') {
            append_code(found, code_unit());
        } else {
            found += index == std::string::npos ? kind : "\b\f\n\r\t"[index];
        }
    }

    unsigned long code_unit()
    {
        const std::string digits = json_.substr(at_ < json_.size() ? at_ : json_.size(), 4);
        at_ += digits.size();
        return std::strtoul(digits.c_str(), nullptr, 16);
    }

    void append_code(std::string &found, unsigned long code)
    {
        const bool is_high = code >= 0xD800 && code < 0xDC00;
        if (is_high && json_.compare(at_, 2, "\\u") == 0) {
            at_ += 2;
            code = 0x10000 + ((code - 0xD800) << 10U) + (code_unit() - 0xDC00);
        }
        const auto append = [&found](unsigned long byte) { found += static_cast<char>(byte); };
        if (code < 0x80) {
            append(code);
        } else if (code < 0x800) {
            append(0xC0 | code >> 6U);
            append(0x80 | (code & 0x3F));
        } else {
            if (code < 0x10000) {
                append(0xE0 | code >> 12U);
            } else {
                append(0xF0 | code >> 18U);
                append(0x80 | (code >> 12U & 0x3F));
            }
            append(0x80 | (code >> 6U & 0x3F));
            append(0x80 | (code & 0x3F));
        }
    }

    const std::string &json_;
    std::size_t at_ = 0;
};

} // namespace session
} // namespace internal
} // namespace rtf

#endif
