"""Writes lines with many signals at a rate: the time, a counter, and other values.

Usage: signal_rows.py SIGNALS RATE
"""

from __future__ import annotations

import itertools
import math
import sys
import time

ROWS = 1000


def main() -> None:
    """Writes until the output is closed. A late line is followed by the next one at once."""
    signals, rate = int(sys.argv[1]), float(sys.argv[2])
    # The values are formatted in advance: this program is not measured, but needs a processor, too.
    rows = [
        " ".join(f"{math.sin(0.01 * row + signal):.5f}" for signal in range(1, signals))
        for row in range(ROWS)
    ]
    start = time.time()
    for number in itertools.count():
        due = start + number / rate
        wait = due - time.time()
        if wait > 0:
            time.sleep(wait)
        print(f"{due:.6f} {number} {rows[number % ROWS]}", flush=True)


if __name__ == "__main__":
    main()
