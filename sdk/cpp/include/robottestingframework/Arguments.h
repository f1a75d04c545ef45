// SPDX-License-Identifier: Apache-2.0
// Splits a parameter string into arguments.
#ifndef ROBOTTESTINGFRAMEWORK_ARGUMENTS_H
#define ROBOTTESTINGFRAMEWORK_ARGUMENTS_H

#include <string>
#include <vector>

namespace robottestingframework {
namespace internal {

// Splits at blanks and at double quotes only; text between two quotes is one argument
// (spec/suite.md). Overwrites the blanks and quotes after arguments with zeros.
inline std::vector<char *> split(char *text)
{
    const auto is_blank = [](char c) { return c == ' '; };
    std::vector<char *> arguments;
    while (*text != '\0') {
        if (is_blank(*text)) {
            *text++ = '\0';
            continue;
        }
        const bool quoted = *text == '"';
        if (quoted) {
            *text++ = '\0';
        }
        arguments.push_back(text);
        while (*text != '\0' && *text != '"' && (quoted || !is_blank(*text))) {
            ++text;
        }
        if (quoted && *text == '"') {
            *text++ = '\0'; // else it begins the next argument, and ends this one
        }
    }
    return arguments;
}

// Arguments like those of main(), which own their text.
class ArgumentList
{
public:
    // With `first` before the arguments of the parameter string.
    ArgumentList(const std::string *first, const std::string &param) : param_(param)
    {
        param_.push_back('\0');
        pointers_ = split(&param_[0]);
        if (first != nullptr) {
            first_ = *first;
            first_.push_back('\0');
            pointers_.insert(pointers_.begin(), &first_[0]);
        }
        pointers_.push_back(nullptr);
    }
    ArgumentList(const ArgumentList &) = delete;
    ArgumentList &operator=(const ArgumentList &) = delete;

    int count() const { return static_cast<int>(pointers_.size()) - 1; }
    char **values() { return pointers_.data(); }

private:
    std::string first_;
    std::string param_;
    std::vector<char *> pointers_;
};

} // namespace internal

class Arguments
{
public:
    // Splits and changes a parameter string. argv must have space for all arguments and
    // a null.
    static void parse(char *azParam, int *argc, char **argv)
    {
        const std::vector<char *> arguments = internal::split(azParam);
        for (std::size_t index = 0; index < arguments.size(); ++index) {
            argv[index] = arguments[index];
        }
        argv[arguments.size()] = nullptr;
        *argc = static_cast<int>(arguments.size());
    }
};

} // namespace robottestingframework

#endif
