"""Trivial Python tests, with a process each or a shared one: a further test, and a run.

They are a separate group with fewer rounds, because starting an interpreter takes long.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

from measuring import suite
from measuring.bench import Bench
from measuring.model import Group, Limit, Line, MeasuringError, Samples, Work
from measuring.slope import FIXED, FURTHER, by_count

FEW = 1000
MANY = 10_000
# pytest needs minutes to fork for each of 10 000 tests.
MANY_PROCESSES = 3000
BARE_FEW = 10
BARE_MANY = 60

BARE = "python3 -c pass"
FORKED = "pytest --forked"
IN_PROCESS = "pytest"
RTF = "rtf, Python"
RTF_SHARED = "rtf, Python, shared"


def group(bench: Bench) -> Group:
    """The peers are pytest with functions as tests, and an interpreter that does nothing."""
    missing = "" if bench.pytest else "pytest is not installed"
    bare = [sys.executable, "-c", "pass"]
    works = (
        Work(BARE, lambda: by_count(lambda n: bench.launch(bare, n).seconds, BARE_FEW, BARE_MANY)),
        Work(FORKED, pytest(bench, MANY_PROCESSES, "--forked"), missing),
        Work(IN_PROCESS, pytest(bench, MANY), missing),
        Work(RTF, rtf(bench, MANY_PROCESSES, "process")),
        Work(RTF_SHARED, rtf(bench, MANY, "shared")),
    )
    quarter = Limit(0.25, of_ratio=True, required=False)
    lines = (
        Line("Python test, own process", RTF, FURTHER, FORKED, quarter),
        Line("Python test, own process, compared with the interpreter", RTF, FURTHER, BARE),
        Line("Python test, shared", RTF_SHARED, FURTHER, IN_PROCESS, quarter),
        Line("Python tests, own process: fixed cost", RTF, FIXED, FORKED),
        Line("Python tests, shared: fixed cost", RTF_SHARED, FIXED, IN_PROCESS),
    )
    return Group("python", works, lines, rounds=3, warm_up=False)


def rtf(bench: Bench, many: int, isolation: str) -> Callable[[], Samples]:
    """Runs the tests with rtf."""

    def seconds(count: int) -> float:
        elements = suite.tests("python", "Trivial", count, isolation)
        file = suite.write(bench, f"trivial-python-{isolation}", elements)
        return suite.run_passing(bench, file, count).seconds

    return lambda: by_count(seconds, FEW, many)


def pytest(bench: Bench, many: int, *options: str) -> Callable[[], Samples]:
    """Runs as many functions with pytest, without its cache."""
    directory = bench.directory / "pytest"
    directory.mkdir(exist_ok=True)
    command = [bench.pytest, "-q", "-p", "no:cacheprovider", *options, str(directory)]

    def seconds(count: int) -> float:
        functions = "".join(f"def test_{n:06}():\n    assert True\n\n\n" for n in range(count))
        (directory / "test_trivial.py").write_text(functions, encoding="utf-8")
        launched = bench.launch(command)
        if f"{count} passed" not in launched.output:
            raise MeasuringError(f"pytest did not pass {count} tests:\n{launched.output}")
        return launched.seconds

    return lambda: by_count(seconds, FEW, many)
