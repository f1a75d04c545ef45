"""Compares distances of dynamic time warping with those of dtaidistance, for random sequences.

    warping.py WARP

With a band, the sequences have the same length: otherwise dtaidistance counts the band from two
diagonals, and rtf from one.
"""

from __future__ import annotations

import random
import subprocess
import sys

from dtaidistance import dtw

PAIRS = 2000


def main() -> int:
    """Compares all; exits at the first difference."""
    generator = random.Random(19)
    pairs = [pair(generator) for _ in range(PAIRS)]
    lines = [
        f"{radius};{','.join(map(repr, first))};{','.join(map(repr, second))}\n"
        for radius, first, second in pairs
    ]
    run = subprocess.run(
        [sys.argv[1]], input="".join(lines), capture_output=True, text=True, check=True
    )
    found = run.stdout.splitlines()
    if len(found) != PAIRS:
        sys.exit(f"{len(found)} results")
    for result, (radius, first, second), line in zip(found, pairs, lines, strict=True):
        # The window of dtaidistance includes the diagonal.
        expected = dtw.distance(first, second, window=radius + 1)
        if abs(float(result) - expected) > 1e-9 * max(1.0, expected):
            sys.exit(f"{result}, expected {expected}: {line}")
    print(f"ok: {PAIRS} distances")
    return 0


def pair(generator: random.Random) -> tuple[int, list[float], list[float]]:
    """A radius, and two sequences: noise, or a motion and its delayed copy."""
    length = generator.randint(1, 60)
    other = length if generator.random() < 0.7 else generator.randint(1, 60)
    radius = generator.randint(0, length) if other == length else 60
    if generator.random() < 0.5:
        first = [generator.uniform(-5, 5) for _ in range(length)]
        return radius, first, [generator.uniform(-5, 5) for _ in range(other)]
    delay = generator.randint(0, 5)
    first = [min(1.0, index / 20) for index in range(length)]
    return radius, first, [min(1.0, max(0.0, (index - delay) / 20)) for index in range(other)]


if __name__ == "__main__":
    sys.exit(main())
