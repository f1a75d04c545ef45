// A program without tests.

#include <cstdio>

int main()
{
    std::puts("Hello, arm.");
}
