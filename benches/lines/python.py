"""Trivial Python tests, with a process each or a shared one.

They are a separate group with fewer rounds, because starting an interpreter takes long.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

from measuring import suite
from measuring.bench import Bench, Launched
from measuring.model import Group, Limit, Line, MeasuringError, Samples, Work

COUNT = 1000
BARE_COUNT = 50
UNIT = "ms a test"

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
        Work(BARE, lambda: a_test(bench.launch(bare, BARE_COUNT), BARE_COUNT)),
        Work(FORKED, pytest(bench, "--forked"), missing),
        Work(IN_PROCESS, pytest(bench), missing),
        Work(RTF, rtf(bench, "process")),
        Work(RTF_SHARED, rtf(bench, "shared")),
    )
    quarter = Limit(0.25, of_ratio=True, required=False)
    lines = (
        Line(f"{COUNT} Python tests, own process each", RTF, UNIT, FORKED, quarter),
        Line(f"{COUNT} Python tests, own process, compared with the interpreter", RTF, UNIT, BARE),
        Line(f"{COUNT} Python tests, shared", RTF_SHARED, UNIT, IN_PROCESS, quarter),
    )
    return Group("python", works, lines, rounds=3, warm_up=False)


def rtf(bench: Bench, isolation: str) -> Callable[[], Samples]:
    """Runs the tests with rtf."""
    elements = suite.tests("python", "Trivial", COUNT, isolation)
    file = suite.write(bench, f"trivial-python-{isolation}", elements)
    return lambda: a_test(suite.run_passing(bench, file, COUNT))


def pytest(bench: Bench, *options: str) -> Callable[[], Samples]:
    """Runs as many functions with pytest, without its cache."""
    directory = bench.directory / "pytest"
    directory.mkdir(exist_ok=True)
    functions = "".join(f"def test_{n:06}():\n    assert True\n\n\n" for n in range(COUNT))
    (directory / "test_trivial.py").write_text(functions, encoding="utf-8")
    command = [bench.pytest, "-q", "-p", "no:cacheprovider", *options, str(directory)]

    def work() -> Samples:
        launched = bench.launch(command)
        if f"{COUNT} passed" not in launched.output:
            raise MeasuringError(f"pytest did not pass {COUNT} tests:\n{launched.output}")
        return a_test(launched)

    return work


def a_test(launched: Launched, count: int = COUNT) -> Samples:
    """The time per test."""
    return {UNIT: [launched.seconds * 1e3 / count]}
