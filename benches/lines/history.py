"""What the import into the history adds to a run."""

from __future__ import annotations

from pathlib import Path

from measuring import suite
from measuring.bench import Bench
from measuring.model import Group, Limit, Line, Samples, Work

COUNT = 100
UNIT = "s"

WITH = "rtf run"
WITHOUT = "rtf run --no-history"


def group(bench: Bench) -> Group:
    """Short tests in one run: the longer they are, the less the import matters."""
    file = suite.write(bench, "imported", suite.tests("dll", "Trivial", COUNT))
    works = (
        Work(WITHOUT, lambda: run(bench, file, "--no-history")),
        Work(WITH, lambda: run(bench, file)),
    )
    line = f"{COUNT} short tests, imported into the history"
    lines = (Line(line, WITH, UNIT, WITHOUT, Limit(1.05, of_ratio=True)),)
    return Group("history", works, lines, rounds=15)


def run(bench: Bench, file: Path, *options: str) -> Samples:
    """One run; the history of the bench grows."""
    with suite.Run(bench, file, options=options) as finished:
        finished.expect("test-finished", COUNT, '"verdict":"passed"')
        return {UNIT: [finished.launched.seconds]}
