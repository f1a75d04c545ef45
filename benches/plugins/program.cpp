// SPDX-License-Identifier: Apache-2.0
// ctest's trivial test: a C++ program. It needs libstdc++, as any test with an
// assertion does.
#include <stdexcept>

int main(int argc, char **)
{
    if (argc > 1) {
        throw std::runtime_error("no arguments are expected");
    }
    return 0;
}
