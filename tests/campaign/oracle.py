#!/usr/bin/env python3
"""Results of SciPy and of a second ChaCha8, with which the tests of campaigns compare.

    oracle.py FILE           writes the file
    oracle.py --check FILE   exit code 1 if the file has other results

The interpreter has the packages of tools/requirements-history.txt.
"""

from __future__ import annotations

import hashlib
import json
import math
import struct
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import two_versions
from scipy import optimize, special, stats
from scipy.stats import qmc

SAME = 1e-9
"""The relative difference of equal results: SciPy's depend on the processor."""

SOBOL_BITS = 30
SOBOL_DIMENSIONS = 64
SOBOL_POINTS = [*range(9), 100, 1023, 1024, 4096]


def main() -> int:
    """Writes or compares the file."""
    file = Path(sys.argv[-1])
    results = {
        "wilson": intervals("wilson"),
        "exact": intervals("exact"),
        "normal_quantile": normal_quantile(),
        "confidence_sequence": confidence_sequence(),
        "mcnemar": mcnemar(),
        "permutation": permutation(),
        **two_versions.results(),
        "random": random(),
        "sobol": sobol(),
    }
    if sys.argv[1] != "--check":
        lines = (f"{json.dumps(name)}: {table(rows)}" for name, rows in results.items())
        file.write_text("{\n" + ",\n".join(lines) + "\n}\n")
        return 0
    stored = json.loads(file.read_text())
    differing = [name for name, rows in results.items() if not same(stored.get(name), rows)]
    for name in differing:
        print(f"failed: {name} differs")
    print(f"{len(results) - len(differing)} passed, {len(differing)} failed")
    return 1 if differing or stored.keys() != results.keys() else 0


def table(rows: list[Any]) -> str:
    """A list with a line for each row."""
    return "[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]"


def same(stored: Any, found: Any) -> bool:
    """Whether two results are equal, except for rounding."""
    if isinstance(found, list):
        return len(stored) == len(found) and all(map(same, stored, found))
    if isinstance(found, float):
        return math.isclose(stored, found, rel_tol=SAME)
    return bool(stored == found)


def intervals(method: str) -> list[list[float]]:
    """Successes, trials, confidence, both ends."""
    cases = [(0, 10, 0.95), (10, 10, 0.95), (5, 10, 0.95), (1, 1, 0.95), (81, 263, 0.95)]
    cases += [(98, 100, 0.99), (3, 1_000_000, 0.95)]
    rows = []
    for successes, trials, confidence in cases:
        test = stats.binomtest(successes, trials)
        interval = test.proportion_ci(confidence, method)
        rows.append([successes, trials, confidence, float(interval.low), float(interval.high)])
    return rows


def normal_quantile() -> list[list[float]]:
    """Probability, quantile."""
    probabilities = [2.0**-53, 1e-12, 1e-9, 1e-5, 0.01, 0.074, 0.076, 0.25, 0.4, 0.6, 0.925]
    probabilities += [0.975, 0.999, 1 - 2.0**-33]
    return [[p, float(special.ndtri(p))] for p in probabilities]


def confidence_sequence() -> list[list[float]]:
    """Successes, trials, confidence, both ends."""
    rows = []
    cases = [(0, 1, 0.95), (0, 50, 0.95), (50, 50, 0.99), (1, 2, 0.9), (93, 100, 0.95)]
    cases += [(9_700, 10_000, 0.99), (500_000, 1_000_000, 0.95)]
    for successes, trials, confidence in cases:
        value = successes / trials
        ends = [0.0, 1.0]
        for side, limit in enumerate((1e-300, 1 - 1e-16)):
            if value != ends[side]:
                of = (successes, trials - successes, confidence)
                ends[side] = optimize.brentq(excess, limit, value, of, xtol=1e-300, rtol=1e-14)
        rows.append([successes, trials, confidence, *ends])
    return rows


def excess(rate: float, successes: int, failures: int, confidence: float) -> float:
    """The logarithm of the martingale for a rate, minus its limit."""
    mixture = special.betaln(successes + 0.5, failures + 0.5) - special.betaln(0.5, 0.5)
    likelihood = special.xlogy(successes, rate) + special.xlog1py(failures, -rate)
    return float(mixture - likelihood + np.log1p(-confidence))


def mcnemar() -> list[list[float]]:
    """Only the first passed, only the second passed, p value."""
    cases = [(0, 1), (0, 5), (2, 3), (3, 11), (10, 30), (40, 41), (120, 180), (4000, 4200)]
    return [[a, b, float(stats.binomtest(a, a + b).pvalue)] for a, b in cases]


def permutation() -> list[list[Any]]:
    """Differences, p value."""
    rng = np.random.default_rng(20261)
    rows = []
    for count in (2, 4, 9, 12):
        differences = np.round(rng.normal(0.5, 1.0, size=count), 3)
        rows.append([differences.tolist(), permuted(differences)])
    ties = np.array([1.0, 1.0, -1.0, 2.0, -2.0, 3.0, 1.0, 1.0])
    return [*rows, [ties.tolist(), permuted(ties)]]


def permuted(differences: np.ndarray[Any, Any]) -> float:
    """The p value of SciPy's test with all signs."""
    test = stats.permutation_test(
        (differences,), np.sum, permutation_type="samples", n_resamples=np.inf
    )
    return float(test.pvalue)


def random() -> list[list[Any]]:
    """Seed, purpose, name, index, the 64 bits as text."""
    cases = [(0, "value", "a", 0), (7, "value", "payload", 3), (2**64 - 1, "shift", "é", 2**40)]
    return [[*case, str(bits(*case))] for case in cases]


def bits(seed: int, purpose: str, name: str, index: int) -> int:
    """The number of a stream as `spec/campaign.md` defines it."""
    key = struct.pack("<Q24x", seed)
    nonce = hashlib.sha256(f"{purpose}/{name}".encode()).digest()[:8]
    block = chacha8(key, nonce, index)
    return block[0] | block[1] << 32


def chacha8(key: bytes, nonce: bytes, counter: int) -> list[int]:
    """A block of ChaCha with eight rounds."""
    constant = struct.unpack("<4I", b"expand 32-byte k")
    start = [*constant, *struct.unpack("<8I", key), counter & 0xFFFFFFFF, counter >> 32]
    start += struct.unpack("<2I", nonce)
    state = list(start)
    columns = [(i, 4 + i, 8 + i, 12 + i) for i in range(4)]
    diagonals = [(i, 4 + (i + 1) % 4, 8 + (i + 2) % 4, 12 + (i + 3) % 4) for i in range(4)]
    for _ in range(4):
        for a, b, c, d in columns + diagonals:
            for x, y, z, shift in ((a, b, d, 16), (c, d, b, 12), (a, b, d, 8), (c, d, b, 7)):
                state[x] = state[x] + state[y] & 0xFFFFFFFF
                mixed = state[z] ^ state[x]
                state[z] = (mixed << shift | mixed >> (32 - shift)) & 0xFFFFFFFF
    return [(a + b) & 0xFFFFFFFF for a, b in zip(state, start, strict=True)]


def sobol() -> list[list[int]]:
    """The index of a point, and its coordinates as 30-bit numbers."""
    sampler = qmc.Sobol(SOBOL_DIMENSIONS, scramble=False, bits=SOBOL_BITS)
    with warnings.catch_warnings():
        # Other numbers of points than a power of two are not balanced: no matter here.
        warnings.simplefilter("ignore", UserWarning)
        points = sampler.random(SOBOL_POINTS[-1] + 1)
    return [[index, *(int(x * 2**SOBOL_BITS) for x in points[index])] for index in SOBOL_POINTS]


if __name__ == "__main__":
    sys.exit(main())
