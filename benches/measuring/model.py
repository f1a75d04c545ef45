"""The vocabulary: works are measured in rounds, lines compare them with a limit."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass

Samples = dict[str, list[float]]
"""What one round of a work gave: its values, by their unit."""

Statistic = Callable[[Sequence[float]], float]


class MeasuringError(Exception):
    """Something did not do what was to be measured."""


@dataclass(frozen=True)
class Work:
    """Something that can be measured, again and again."""

    name: str
    run: Callable[[], Samples]
    missing: str = ""
    """Why it cannot be measured on this machine; empty if it can."""


@dataclass(frozen=True)
class Limit:
    """What a line has to keep."""

    bound: float
    of_ratio: bool = False
    """The ratio to the peer is limited, not the value."""
    at_least: bool = False
    required: bool = True
    """False: a goal that is shown; missing it has no consequence."""

    def holds(self, number: float) -> bool:
        """Whether the number is on the right side."""
        return number >= self.bound if self.at_least else number <= self.bound


@dataclass(frozen=True)
class Line:
    """One line of the table."""

    what: str
    work: str
    unit: str
    peer: str = ""
    """The work whose value, in the same unit and the same round, is 1."""
    limit: Limit | None = None
    statistic: Statistic = statistics.median


@dataclass(frozen=True)
class Group:
    """Works that take turns in each round, and the lines drawn from them."""

    name: str
    works: tuple[Work, ...]
    lines: tuple[Line, ...]
    rounds: int = 7
    warm_up: bool = True
    """Each work is run once before the first round."""

    def work(self, name: str) -> Work:
        """The work of this name."""
        return next(work for work in self.works if work.name == name)


def high_percentile(values: Sequence[float]) -> float:
    """The smallest value that 99 % of the values do not exceed."""
    ordered = sorted(values)
    return ordered[-(-len(ordered) * 99 // 100) - 1]
