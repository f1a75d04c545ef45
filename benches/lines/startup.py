"""The duration of commands."""

from __future__ import annotations

from measuring import suite
from measuring.bench import Bench, Launched
from measuring.model import Group, Limit, Line, Samples, Work

COUNT = 50
UNIT = "ms"

SPAWN = "/bin/true"
VERSION = "rtf --version"
ONE_TEST = "rtf run"


def group(bench: Bench) -> Group:
    """Each sample is one process."""
    file = suite.write(bench, "one", suite.tests("dll", "Trivial", 1))
    works = (
        Work(SPAWN, lambda: each(bench.launch(["/bin/true"], COUNT))),
        Work(VERSION, lambda: each(bench.launch([str(bench.rtf), "--version"], COUNT))),
        Work(ONE_TEST, lambda: each(suite.run_passing(bench, file, 1))),
    )
    lines = (
        Line("rtf --version", VERSION, UNIT, SPAWN, Limit(10)),
        Line("rtf --version: goal", VERSION, UNIT, SPAWN, Limit(5, required=False)),
        Line("rtf run of one trivial test", ONE_TEST, UNIT, SPAWN, Limit(6, required=False)),
    )
    return Group("start", works, lines)


def each(launched: Launched) -> Samples:
    """The duration of each process."""
    return {UNIT: [child.seconds * 1e3 for child in launched.children]}
