/* The program that the tests start: `arm MODE`. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int waits_for_nothing(void)
{
    for (;;) {
        pause();
    }
}

int main(int argc, char **argv)
{
    const char *mode = argc > 1 ? argv[1] : "";
    if (strcmp(mode, "crash") == 0) {
        puts("about to crash");
        fflush(stdout);
        raise(SIGSEGV);
    }
    if (strcmp(mode, "hang") == 0) {
        return waits_for_nothing();
    }
    if (strcmp(mode, "say") == 0) {
        puts(argv[2]);
        fputs("on stderr\n", stderr);
        return argc > 3 ? atoi(argv[3]) : 0;
    }
    return 0;
}
