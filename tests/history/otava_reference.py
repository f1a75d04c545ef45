"""Apache Otava: its change points of a series, and the series in its own tests."""

from __future__ import annotations

import ast
import csv
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from otava import analysis
from scipy.stats import ttest_ind_from_stats

VERSION = "0.8.0"
SHA256 = "9ae53559c9396f27053db7d853780fb2ddbbf70f59124591c44b23fa2e2f9d94"
SHORTEST = 8
"""Shorter lists in Otava's tests are no series."""


@dataclass
class Point:
    """A change as Otava describes it."""

    index: int
    before: float
    after: float
    p_value: float


def change_points(series: Sequence[float]) -> list[Point]:
    """The change points with Otava's default options."""
    # A list: Otava 0.8 does not cut its windows out of an array.
    found, _ = analysis.compute_change_points([float(value) for value in series])
    return [
        Point(int(p.index), float(p.stats.mean_1), float(p.stats.mean_2), float(p.stats.pvalue))
        for p in found
    ]


@contextmanager
def corrected() -> Iterator[None]:
    """In a `with`, Otava 0.8 without two mistakes.

    It estimates variances with the divisor n - 1, as the t-test requires: Otava passes standard
    deviations with the divisor n to a function that expects n - 1. When it removes a weak point,
    it tests all others again: Otava omits the one before.
    """
    original = analysis.TTestSignificanceTester.compare, analysis.merge
    analysis.TTestSignificanceTester.compare, analysis.merge = compare, merge
    try:
        yield
    finally:
        analysis.TTestSignificanceTester.compare, analysis.merge = original


def merge(points: Any, series: Sequence[float], max_p: float, _min_magnitude: float) -> Any:
    """Removes the point with the largest p value until all are significant."""
    tester = analysis.TTestSignificanceTester(max_p)
    while points and max(point.stats.pvalue for point in points) >= max_p:
        points.remove(max(points, key=lambda point: point.stats.pvalue))
        intervals = tester.get_intervals(points)
        points = [tester.change_point(p.to_candidate(), series, intervals) for p in points]
    return points


def compare(_tester: object, left: Sequence[float], right: Sequence[float]) -> analysis.TTestStats:
    """The t-test of both sides, by SciPy."""
    means = np.mean(left), np.mean(right)
    deviations = [np.std(side, ddof=1) if len(side) > 1 else 0.0 for side in (left, right)]
    p_value = 1.0
    if len(left) + len(right) > 2:
        test = ttest_ind_from_stats(
            means[0], deviations[0], len(left), means[1], deviations[1], len(right)
        )
        p_value = test.pvalue
    return analysis.TTestStats(
        mean_1=means[0], mean_2=means[1], std_1=deviations[0], std_2=deviations[1], pvalue=p_value
    )


def own_series(source: Path) -> dict[str, list[float]]:
    """The series in Otava's tests and examples, without duplicates."""
    found: dict[tuple[float, ...], str] = {}
    for path in sorted(source.rglob("tests/*.py")):
        for number, series in enumerate(literals(path)):
            found.setdefault(tuple(series), f"{path.name} {number}")
    for path in sorted(source.rglob("*.csv")):
        for column, series in columns(path):
            found.setdefault(tuple(series), f"{path.name} {column}")
    return {name: list(series) for series, name in found.items() if len(series) >= SHORTEST}


def literals(path: Path) -> Iterator[list[float]]:
    """The lists of numbers in a Python file."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.List):
            try:
                values = ast.literal_eval(node)
            except ValueError:
                continue
            if all(type(value) in (int, float) for value in values):
                yield [float(value) for value in values]


def columns(path: Path) -> Iterator[tuple[str, list[float]]]:
    """The columns of a table that are metrics."""
    text = path.read_text(encoding="utf-8")
    if text.startswith("#"):
        return
    rows = list(csv.DictReader(text.splitlines(), delimiter=";" if ";" in text else ","))
    for name in rows[0]:
        if name.startswith("metric"):
            yield name, [float(row[name]) for row in rows]
