"""The cost of a further test, apart from what a run costs in any case."""

from __future__ import annotations

from collections.abc import Callable

from measuring.model import Samples

FURTHER = "ms a further test"
FIXED = "ms a run"


def by_count(seconds: Callable[[int], float], few: int, many: int) -> Samples:
    """Measures a work with few and with many tests, which gives the slope, and with one test: its
    time apart from that of a further one.
    """
    one, short, long = seconds(1), seconds(few), seconds(many)
    further = (long - short) / (many - few)
    return {FURTHER: [further * 1e3], FIXED: [(one - further) * 1e3]}
