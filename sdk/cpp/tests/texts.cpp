// SPDX-License-Identifier: Apache-2.0
// Compares the numbers in its arguments: plain or angle, got, expected, tolerance.
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include <rtf/TestCase.hpp>

namespace {

double number(const std::string &text)
{
    return std::strtod(text.c_str(), nullptr);
}

// The numbers in `[1,2]`.
std::vector<double> vector(const std::string &text)
{
    std::istringstream numbers(text.substr(1, text.size() - 2));
    std::vector<double> found;
    for (std::string one; std::getline(numbers, one, ',');) {
        found.push_back(number(one));
    }
    return found;
}

class Texts : public rtf::TestCase
{
public:
    bool setup(int argc, char **argv) override
    {
        arguments_.assign(argv + 1, argv + argc);
        return true;
    }

    void run() override
    {
        for (std::size_t at = 0; at + 3 < arguments_.size(); at += 4) {
            const bool is_angle = arguments_[at] == "angle";
            const std::string &got = arguments_[at + 1];
            const std::string &expected = arguments_[at + 2];
            const double tolerance = number(arguments_[at + 3]);
            if (got[0] == '[' && is_angle) {
                RTF_CHECK_ANGLE_NEAR(vector(got), vector(expected), tolerance, "x");
            } else if (got[0] == '[') {
                RTF_CHECK_NEAR(vector(got), vector(expected), tolerance, "x");
            } else if (is_angle) {
                RTF_CHECK_ANGLE_NEAR(number(got), number(expected), tolerance, "x");
            } else {
                RTF_CHECK_NEAR(number(got), number(expected), tolerance, "x");
            }
        }
    }

private:
    std::vector<std::string> arguments_;
};

} // namespace

RTF_PLUGIN(Texts)
