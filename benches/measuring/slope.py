"""The cost of a further test, apart from what a run costs in any case."""

from __future__ import annotations

from collections.abc import Callable

from measuring.model import Samples

FURTHER = "ms a further test"
FIXED = "ms a run"


def by_count(seconds: Callable[[int], float], few: int, many: int) -> Samples:
    """Measures a work with few and with many tests: the slope, and the rest of the shorter one."""
    short, long = seconds(few), seconds(many)
    further = (long - short) / (many - few)
    return {FURTHER: [further * 1e3], FIXED: [(short - further * few) * 1e3]}
