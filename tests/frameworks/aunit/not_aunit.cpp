// A program without AUnit.
#include <cstdio>

int main()
{
    std::puts("OK (3)");
    return 0;
}
