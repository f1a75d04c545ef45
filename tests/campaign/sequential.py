#!/usr/bin/env python3
"""Compares the confidence sequences of campaigns with those of the package savvi.

    sequential.py FILE

FILE is scipy.json, with which the tests of campaigns compare. The interpreter has the packages of
tools/requirements-sequential.txt.
"""

from __future__ import annotations

import json
import sys
import warnings
from pathlib import Path

import numpy as np
from savvi.multinomial import Multinomial

NEAR = 1e-6
"""savvi solves for the ends of an interval numerically."""


def main() -> int:
    """Exits with 1 if an interval differs."""
    warnings.filterwarnings("ignore", category=RuntimeWarning)
    rows = json.loads(Path(sys.argv[1]).read_text())["confidence_sequence"]
    failed = 0
    for successes, trials, confidence, low, high in rows:
        # The mixture is Beta(1/2, 1/2).
        inference = Multinomial(1 - confidence, np.array([0.5, 0.5]), k=1)
        inference.update(np.array([successes, trials - successes]))
        found = inference.calculate_conf_int()[0]
        if abs(found[0] - low) > NEAR or abs(found[1] - high) > NEAR:
            print(f"failed: {successes} of {trials}: {found}, expected {low} to {high}")
            failed += 1
    print(f"{len(rows) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
