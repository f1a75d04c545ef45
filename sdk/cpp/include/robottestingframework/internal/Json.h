// SPDX-License-Identifier: Apache-2.0
// Text as a JSON string.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_JSON_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_JSON_H

#include <cstddef>
#include <cstdio>
#include <string>

namespace robottestingframework {
namespace internal {

// The length of the UTF-8 character at this position; 0 if there is none.
inline std::size_t utf8_length(const std::string &text, std::size_t at)
{
    const auto byte = [&](std::size_t index) {
        return index < text.size() ? static_cast<unsigned char>(text[index]) : 0U;
    };
    const unsigned first = byte(at);
    const unsigned second = byte(at + 1);
    std::size_t length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    // No lone continuation byte, no overlong form, no surrogate.
    const bool wrong = (first >= 0x80 && first < 0xC2) || first > 0xF4 ||
                       (first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
                       (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F);
    for (std::size_t index = 1; index < length; ++index) {
        if ((byte(at + index) & 0xC0U) != 0x80U) {
            return 0;
        }
    }
    return wrong ? 0 : length;
}

// The text in double quotes. Invalid UTF-8 becomes U+FFFD.
inline std::string json_string(const std::string &text)
{
    std::string json = "\"";
    std::size_t at = 0;
    while (at < text.size()) {
        const char letter = text[at];
        const std::size_t length = utf8_length(text, at);
        if (length == 0) {
            json += "\xEF\xBF\xBD";
        } else if (letter == '"' || letter == '\\') {
            json += '\\';
            json += letter;
        } else if (static_cast<unsigned char>(letter) < 0x20) {
            char code[8];
            std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(letter));
            json += code;
        } else {
            json.append(text, at, length);
        }
        at += length == 0 ? 1 : length;
    }
    return json + "\"";
}

} // namespace internal
} // namespace robottestingframework

#endif
