// SPDX-License-Identifier: Apache-2.0
// Four letters in a number.
#ifndef ROBOTTESTINGFRAMEWORK_VOCAB_H
#define ROBOTTESTINGFRAMEWORK_VOCAB_H

#include <cstddef>
#include <cstdint>
#include <string>

namespace shlibpp {

constexpr std::int32_t VOCAB(char a, char b = 0, char c = 0, char d = 0)
{
    return static_cast<std::int32_t>(
        static_cast<std::uint32_t>(static_cast<unsigned char>(a)) |
        static_cast<std::uint32_t>(static_cast<unsigned char>(b)) << 8 |
        static_cast<std::uint32_t>(static_cast<unsigned char>(c)) << 16 |
        static_cast<std::uint32_t>(static_cast<unsigned char>(d)) << 24);
}

class Vocab
{
public:
    // The first four letters.
    static int encode(const std::string &s)
    {
        const auto letter = [&](std::size_t index) { return index < s.size() ? s[index] : '\0'; };
        return VOCAB(letter(0), letter(1), letter(2), letter(3));
    }
    static std::string decode(int code)
    {
        std::string letters;
        for (auto rest = static_cast<std::uint32_t>(code); rest != 0; rest >>= 8) {
            letters.push_back(static_cast<char>(rest & 0xFF));
        }
        return letters;
    }
};

} // namespace shlibpp

#endif
