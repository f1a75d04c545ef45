"""Computes a line's numbers and verdict from its rounds."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from operator import truediv

from measuring.model import Group, Limit, Line
from measuring.rounds import Rounds

OK = "ok"
FAILED = "FAILED"
REACHED = "reached"
MISSED = "missed"
NOT_MEASURED = "not measured"


@dataclass(frozen=True)
class Judgement:
    """The result of a line."""

    group: str
    line: Line
    verdict: str
    """Empty if the line has no limit."""
    value: float | None = None
    ratios: list[float] | None = None
    """The ratio to the peer in each round."""
    note: str = ""
    foreign_share: float = 0.0
    """The share of the processors that other programs used."""

    @property
    def ratio(self) -> float | None:
        """The median of the rounds' ratios."""
        return statistics.median(self.ratios) if self.ratios else None

    @property
    def fails(self) -> bool:
        """Whether this line fails the run."""
        required = self.line.limit is not None and self.line.limit.required
        return self.verdict == FAILED or (required and self.verdict == NOT_MEASURED)


def judge(group: Group, line: Line, rounds: Rounds) -> Judgement:
    """Judges a line by its rounds."""
    for name in filter(None, (line.work, line.peer)):
        missing = group.work(name).missing
        if missing:
            return Judgement(group.name, line, NOT_MEASURED, note=f"{line.what}: {missing}")
    own = [samples[line.unit] for samples in rounds[line.work]]
    value = line.statistic([number for numbers in own for number in numbers])
    ratios = None
    if line.peer:
        peer = [samples[line.unit] for samples in rounds[line.peer]]
        ratios = list(map(truediv, map(line.statistic, own), map(line.statistic, peer)))
    limited = statistics.median(ratios) if ratios and of_ratio(line.limit) else value
    return Judgement(group.name, line, verdict(line.limit, limited), value, ratios)


def of_ratio(limit: Limit | None) -> bool:
    """Whether the limit applies to the ratio to the peer."""
    return limit is not None and limit.of_ratio


def verdict(limit: Limit | None, number: float) -> str:
    """The verdict on a number."""
    if limit is None:
        return ""
    if limit.required:
        return OK if limit.holds(number) else FAILED
    return REACHED if limit.holds(number) else MISSED
