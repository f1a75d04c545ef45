"""The data types: works are measured in rounds, and lines compare them with limits."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass

Samples = dict[str, list[float]]
"""The values of one round of a work, by unit."""

Statistic = Callable[[Sequence[float]], float]


class MeasuringError(Exception):
    """A program is missing or did not do the work to be measured."""


@dataclass(frozen=True)
class Work:
    """A program run that can be measured repeatedly."""

    name: str
    run: Callable[[], Samples]
    missing: str = ""
    """Why it cannot be measured on this machine; empty if it can."""


@dataclass(frozen=True)
class Limit:
    """The limit of a line."""

    bound: float
    of_ratio: bool = False
    """Whether the ratio to the peer is limited instead of the value."""
    at_least: bool = False
    required: bool = True
    """False for a goal, which cannot fail the run."""

    def holds(self, number: float) -> bool:
        """Whether the number is within the limit."""
        return number >= self.bound if self.at_least else number <= self.bound


@dataclass(frozen=True)
class Line:
    """One line of the table."""

    what: str
    work: str
    unit: str
    peer: str = ""
    """The work to compare with, in the same unit and round."""
    limit: Limit | None = None
    statistic: Statistic = statistics.median


@dataclass(frozen=True)
class Group:
    """Works that alternate in each round, and the lines that use them."""

    name: str
    works: tuple[Work, ...]
    lines: tuple[Line, ...]
    rounds: int = 7
    warm_up: bool = True
    """Whether each work runs once before the first round."""

    def work(self, name: str) -> Work:
        """The work with this name."""
        return next(work for work in self.works if work.name == name)


def high_percentile(values: Sequence[float]) -> float:
    """The 99th percentile."""
    ordered = sorted(values)
    return ordered[-(-len(ordered) * 99 // 100) - 1]
