// SPDX-License-Identifier: Apache-2.0
// The trivial test for ctest: a C++ program that needs libstdc++, like any test with an
// assertion.
#include <stdexcept>

int main(int argc, char **)
{
    if (argc > 1) {
        throw std::runtime_error("no arguments are expected");
    }
    return 0;
}
