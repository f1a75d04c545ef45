"""Made series with planted changes. All are drawn from one seed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

SEED = 20261
Floats = NDArray[np.float64]


@dataclass
class Series:
    """A series and where its mean changes."""

    values: list[float]
    changes: list[int]


def make(kind: str, count: int) -> list[Series]:
    """Draws `count` series of a kind, which are the same each time."""
    number = list(KINDS).index(kind)
    rng = np.random.default_rng([SEED, number])
    return [KINDS[kind](rng) for _ in range(count)]


def levels(rng: np.random.Generator, lengths: list[int], means: list[float]) -> Series:
    """Segments with these means, and normal noise with the standard deviation 1."""
    values = np.repeat(means, lengths) + rng.normal(size=sum(lengths))
    return Series(values.tolist(), np.cumsum(lengths)[:-1].tolist())


def flat(rng: np.random.Generator) -> Series:
    """No change."""
    return levels(rng, [int(rng.integers(20, 200))], [100.0])


def heavy(rng: np.random.Generator) -> Series:
    """No change, but the noise has heavy tails: Student's t with 3 degrees of freedom."""
    return Series((100 + rng.standard_t(3, size=int(rng.integers(20, 200)))).tolist(), [])


def skewed(rng: np.random.Generator) -> Series:
    """No change, and skewed like durations: log-normal."""
    return Series(rng.lognormal(0.0, 0.5, size=int(rng.integers(20, 200))).tolist(), [])


def step(size: float) -> Callable[[np.random.Generator], Series]:
    """One change by `size` standard deviations, up or down."""

    def draw(rng: np.random.Generator) -> Series:
        before, after = (int(n) for n in rng.integers(15, 100, size=2))
        return levels(rng, [before, after], [100.0, 100.0 + size * rng.choice([-1, 1])])

    return draw


def several(rng: np.random.Generator) -> Series:
    """Three to six changes by 4 to 10 standard deviations."""
    lengths = rng.integers(12, 60, size=int(rng.integers(4, 8))).tolist()
    sizes = rng.uniform(4, 10, size=len(lengths)) * rng.choice([-1, 1], size=len(lengths))
    return levels(rng, lengths, (100 + np.cumsum(sizes)).tolist())


def recent(after: int) -> Callable[[np.random.Generator], Series]:
    """A change by 6 standard deviations, `after` values before the end."""

    def draw(rng: np.random.Generator) -> Series:
        return levels(rng, [int(rng.integers(20, 80)), after], [100.0, 106.0])

    return draw


def too_recent(rng: np.random.Generator) -> Series:
    """The last two values differ, which is too few for a change."""
    series = recent(2)(rng)
    return Series(series.values, [])


def outliers(changes: bool) -> Callable[[np.random.Generator], Series]:
    """Every twentieth value is wrong by 20 standard deviations; with or without a change by 4."""

    def draw(rng: np.random.Generator) -> Series:
        series = step(4.0 if changes else 0.0)(rng)
        wrong = rng.random(len(series.values)) < 0.05
        values = np.array(series.values) + 20.0 * wrong
        return Series(values.tolist(), series.changes if changes else [])

    return draw


def rounded(rng: np.random.Generator) -> Series:
    """A change of a value with few digits, like a count."""
    series = step(4.0)(rng)
    return Series(np.round(series.values).tolist(), series.changes)


KINDS: dict[str, Callable[[np.random.Generator], Series]] = {
    "flat": flat,
    "flat, heavy tails": heavy,
    "flat, skewed": skewed,
    "flat, outliers": outliers(False),
    "flat, last 2 differ": too_recent,
    "step of 1.5": step(1.5),
    "step of 2": step(2.0),
    "step of 4": step(4.0),
    "step of 4, rounded": rounded,
    "step of 4, outliers": outliers(True),
    "several steps": several,
    "step of 6, 3 values ago": recent(3),
    "step of 6, 5 values ago": recent(5),
}
