"""Trivial Python tests, each in a process of its own.

A group of its own: the interpreter's start is dear, so there are fewer tests
and fewer rounds.
"""

from __future__ import annotations

import sys

from measuring import suite
from measuring.bench import Bench, Launched
from measuring.model import Group, Line, Samples, Work

COUNT = 200
UNIT = "ms a test"

BARE = "python3 -c pass"
RTF = "rtf, Python"


def group(bench: Bench) -> Group:
    """The peer is the interpreter that does nothing."""
    file = suite.write(bench, "trivial-python", suite.tests("python", "Trivial", COUNT))
    works = (
        Work(BARE, lambda: a_test(bench.launch([sys.executable, "-c", "pass"], COUNT))),
        Work(RTF, lambda: a_test(suite.run_passing(bench, file, COUNT))),
    )
    lines = (Line(f"{COUNT} Python tests, own process each", RTF, UNIT, BARE),)
    return Group("python", works, lines, rounds=3, warm_up=False)


def a_test(launched: Launched) -> Samples:
    """The price of one of them."""
    return {UNIT: [launched.seconds * 1e3 / COUNT]}
