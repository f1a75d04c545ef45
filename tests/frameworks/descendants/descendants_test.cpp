// A program without a framework, for the types `program`, `ctest` and `tap`.
//
//     descendants_test NAME          the exit code is the result of a case
//     descendants_test tap NAME…     prints TAP
//
// Its cases start processes, see descendants.hpp.
#include <cstdio>
#include <cstring>

#include "descendants.hpp"

struct Case
{
    const char *name;
    bool (*deed)();
};

#define CASE(name) {#name, descendants::name},
static const Case cases[] = {DESCENDANTS(CASE)};
#undef CASE

static bool holds(const char *name)
{
    for (const Case &each : cases) {
        if (std::strcmp(each.name, name) == 0) {
            return descendants::holds(each.deed);
        }
    }
    std::fprintf(stderr, "no case %s\n", name);
    std::exit(2);
}

int main(int argc, char **argv)
{
    // A forked process must not print again what its parent printed.
    std::setvbuf(stdout, nullptr, _IONBF, 0);
    const bool is_tap = argc > 1 && std::strcmp(argv[1], "tap") == 0;
    bool has_failed = argc < 2;
    if (is_tap) {
        std::printf("1..%d\n", argc - 2);
    }
    for (int at = is_tap ? 2 : 1; at < argc; ++at) {
        const bool has_passed = holds(argv[at]);
        has_failed = has_failed || !has_passed;
        if (is_tap) {
            std::printf("%s %d - %s\n", has_passed ? "ok" : "not ok", at - 1, argv[at]);
        }
    }
    return has_failed ? 1 : 0;
}
