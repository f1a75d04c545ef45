// The cases of descendants.hpp for other languages.
#include <cstdio>
#include <cstring>

#include "descendants.hpp"

// Whether a case holds; a negative number if there is none with this name.
extern "C" int descendants_hold(const char *name)
{
#define CASE(deed)                                                                                 \
    if (std::strcmp(name, #deed) == 0) {                                                           \
        return descendants::holds(descendants::deed) ? 1 : 0;                                      \
    }
    DESCENDANTS(CASE)
    std::fprintf(stderr, "no case %s\n", name);
    return -1;
}
