/* The program of a `process` fixture: writes its process id and waits for a signal.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <unistd.h>

#include "collapse.h"

int main(int argc, char **argv)
{
    if (argc != 2 || write_pid(argv[1], (long)getpid()) != 0) {
        fputs("usage: victim PID_FILE\n", stderr);
        return 1;
    }
    puts("ready");
    fflush(stdout);
    for (;;) {
        pause();
    }
}
