// A program that knows nothing of GoogleTest.

#include <cstdio>

int main()
{
    std::puts("Hello, arm.");
}
