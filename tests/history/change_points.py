"""Compares the change points of rtf-history with Apache Otava's, or with planted changes.

    change_points.py CHANGE_POINTS otava|planted

CHANGE_POINTS is the example of crates/rtf-history with that name.
The interpreter has the packages of tools/requirements-history.txt. Part of test_history.py.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
from dataclasses import dataclass
from typing import Any

import made_series as made
import otava_reference as oracle
from sdist import fetch

PER_KIND = 60
OWN_FEWEST = 15
"""Otava's tests have more series. A comparison of none would pass."""

UNCHANGED_SHARE = 0.9
"""The part of the series for which Otava's two mistakes make no difference."""

NEAR = 3
"""A change that is found at most this many values from a planted one is that one."""

FALSE_CHANGES = 2
"""Most changes in all series of a kind that has none."""

LIMITS = {
    # kind: lowest precision, lowest recall
    "step of 1.5": (0.80, 0.65),
    "step of 2": (0.90, 0.90),
    "step of 4": (0.98, 0.98),
    "step of 4, rounded": (0.98, 0.98),
    "step of 4, outliers": (0.75, 0.15),
    "several steps": (0.98, 0.97),
    "step of 6, 3 values ago": (0.98, 0.95),
    "step of 6, 5 values ago": (0.98, 0.98),
}


@dataclass
class Score:
    """The changes in all series of a kind."""

    planted: int = 0
    found: int = 0
    right: int = 0

    def add(self, planted: list[int], found: list[int]) -> None:
        """Counts a series."""
        self.planted += len(planted)
        self.found += len(found)
        free = list(found)
        for change in planted:
            nearest = min(free, key=lambda index: abs(index - change), default=math.inf)
            if abs(nearest - change) <= NEAR:
                free.remove(int(nearest))
                self.right += 1

    @property
    def precision(self) -> float:
        """The part of the found changes that were planted."""
        return self.right / self.found if self.found else math.nan

    @property
    def recall(self) -> float:
        """The part of the planted changes that were found."""
        return self.right / self.planted if self.planted else math.nan

    def row(self) -> str:
        """The columns of the table."""
        return f"{self.found:7} {self.precision:10.3f} {self.recall:8.3f}"


def main() -> int:
    """Prints all differences; the exit code is 1 if there is one."""
    program, part = sys.argv[1:]
    problems = compare(program) if part == "otava" else score_all(program)
    for problem in problems:
        print(f"failed: {problem}")
    return 1 if problems else 0


def compare(program: str) -> list[str]:
    """Compares each point with those of Otava without its mistakes, by the same definition."""
    own = oracle.own_series(fetch(sys.executable, "apache_otava", oracle.VERSION, oracle.SHA256))
    series = own | {
        f"{kind} {number}": one.values
        for kind in made.KINDS
        for number, one in enumerate(made.make(kind, PER_KIND))
    }
    answers = run(program, list(series.values()), per_test=0.001, min_segment=1)
    problems = []
    unchanged = points = 0
    for (name, values), answer in zip(series.items(), answers, strict=True):
        with oracle.corrected():
            expected = oracle.change_points(values)
        found = [read_point(point) for point in answer["points"]]
        if not same(expected, found):
            problems.append(f"{name}: Otava {expected}, rtf {found}")
        points += len(expected)
        unchanged += [p.index for p in expected] == [p.index for p in oracle.change_points(values)]
    print(f"{points} points in {len(series)} series: {len(problems)} series differ from Otava's")
    print(f"Otava as it is finds the same points in {unchanged} of these series")
    if unchanged < UNCHANGED_SHARE * len(series):
        problems.append("Otava's mistakes make more difference than documented")
    if len(own) < OWN_FEWEST:
        problems.append(f"only {len(own)} series in Otava's tests, expected {OWN_FEWEST}")
    return problems


def same(expected: list[oracle.Point], found: list[oracle.Point]) -> bool:
    """Whether two lists are equal except for rounding."""
    return len(expected) == len(found) and all(
        a.index == b.index
        and math.isclose(a.before, b.before, rel_tol=1e-9, abs_tol=1e-12)
        and math.isclose(a.after, b.after, rel_tol=1e-9, abs_tol=1e-12)
        and math.isclose(a.p_value, b.p_value, rel_tol=1e-6, abs_tol=1e-300)
        for a, b in zip(expected, found, strict=True)
    )


def score_all(program: str) -> list[str]:
    """Prints a table, and checks it."""
    print(f"{'':26} {'rtf':>35} {'Otava':>27}")
    names = f"{'found':>7} {'precision':>10} {'recall':>8}"
    print(f"{'kind':26} {'planted':>7} {names} {names}")
    return [problem for kind in made.KINDS for problem in score(program, kind)]


def score(program: str, kind: str) -> list[str]:
    """Prints a line of the table, and checks it."""
    drawn = made.make(kind, PER_KIND)
    ours, theirs = Score(), Score()
    answers = run(program, [one.values for one in drawn])
    for one, answer in zip(drawn, answers, strict=True):
        ours.add(one.changes, [point["index"] for point in answer["points"]])
        theirs.add(one.changes, [point.index for point in oracle.change_points(one.values)])
    print(f"{kind:26} {ours.planted:7} {ours.row()} {theirs.row()}")
    if not ours.planted:
        enough = ours.found <= FALSE_CHANGES
        return [] if enough else [f"{kind}: more than {FALSE_CHANGES} false changes"]
    precision, recall = LIMITS[kind]
    if ours.precision >= precision and ours.recall >= recall:
        return []
    return [f"{kind}: less than precision {precision}, recall {recall}"]


def run(program: str, series: list[list[float]], **options: float) -> list[dict[str, Any]]:
    """The answers of CHANGE_POINTS."""
    lines = [json.dumps({"values": values, **options}) for values in series]
    done = subprocess.run(
        [program], input="\n".join(lines), text=True, stdout=subprocess.PIPE, check=True
    )
    return [json.loads(line) for line in done.stdout.splitlines()]


def read_point(point: dict[str, Any]) -> oracle.Point:
    """A point of an answer."""
    before, after = point["before"]["mean"], point["after"]["mean"]
    return oracle.Point(point["index"], before, after, point["p_value"])


if __name__ == "__main__":
    sys.exit(main())
