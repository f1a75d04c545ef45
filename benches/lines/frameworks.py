"""1000 cases of GoogleTest and pytest, compared with the program or the framework alone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from measuring import suite
from measuring.bench import Bench, Launched
from measuring.model import Group, Limit, Line, MeasuringError, Samples, Work

COUNT = 1000
LARGE_COUNT = 5000
UNIT = "ms a case"

BARE = "the program alone"
BARE_BUSY = "the program alone, 1 ms a case"
RTF = "rtf, gtest"
RTF_BUSY = "rtf, gtest, 1 ms a case"
BARE_COUNTED = "the program alone, 1 to 5000 cases"
RTF_COUNTED = "rtf, gtest, 1 to 5000 cases"
FIRST = "ms a run"
FURTHER = "µs a further case"
RTF_SEPARATE = "rtf, gtest, a process for each case"
RTF_AT_MAIN = "rtf, gtest, a process for each case, forked at main"
CTEST = "ctest with an entry for each case"
PYTEST = "pytest alone"
RTF_PYTEST = "rtf, pytest"


def group(bench: Bench) -> Group:
    """A case that does nothing takes a microsecond; one of a robot at least a millisecond."""
    no_gtest = "" if bench.gtest else "GoogleTest is not installed"
    no_ctest = no_gtest or ("" if bench.ctest else "ctest is not installed")
    no_pytest = "" if bench.pytest else "pytest is not installed"
    trivial, busy = str(bench.directory / "gtest"), str(bench.directory / "gtest-busy")
    works = (
        Work(BARE, lambda: a_case(bench.launch([trivial])), no_gtest),
        Work(RTF, rtf(bench, "gtest"), no_gtest),
        Work(BARE_COUNTED, lambda: counted(lambda n: bare_counted(bench, n)), no_gtest),
        Work(RTF_COUNTED, lambda: counted(lambda n: rtf_counted(bench, n)), no_gtest),
        Work(BARE_BUSY, lambda: a_case(bench.launch([busy])), no_gtest),
        Work(RTF_BUSY, rtf(bench, "gtest-busy"), no_gtest),
        Work(CTEST, ctest(bench, trivial), no_ctest),
        Work(RTF_SEPARATE, rtf(bench, "gtest", ' isolation="case"'), no_gtest),
        Work(RTF_AT_MAIN, rtf(bench, "gtest", ' isolation="case" fork="main"'), no_gtest),
        Work(PYTEST, pytest(bench), no_pytest),
        Work(RTF_PYTEST, rtf_pytest(bench), no_pytest),
    )
    near_bare = Limit(1.3, of_ratio=True)
    goal = Limit(1.3, of_ratio=True, required=False)
    half = Limit(0.5, of_ratio=True, required=False)
    near_pytest = Limit(1.15, of_ratio=True)
    lines = (
        Line(f"{COUNT} gtest cases of 1 ms, one process", RTF_BUSY, UNIT, BARE_BUSY, near_bare),
        Line(f"{COUNT} gtest cases that do nothing, one process: goal", RTF, UNIT, BARE, goal),
        Line("one gtest case", RTF_COUNTED, FIRST, BARE_COUNTED),
        Line("each further gtest case that does nothing", RTF_COUNTED, FURTHER, BARE_COUNTED),
        Line(f"{COUNT} gtest cases, own process each: goal", RTF_SEPARATE, UNIT, CTEST, half),
        Line(f"{COUNT} gtest cases, forked at main: goal", RTF_AT_MAIN, UNIT, CTEST, half),
        Line(f"{COUNT} pytest functions", RTF_PYTEST, UNIT, PYTEST, near_pytest),
    )
    return Group("frameworks", works, lines, rounds=3)


def rtf(bench: Bench, program: str, attributes: str = "") -> Callable[[], Samples]:
    """Runs a program of GoogleTest with rtf."""
    name = program + "".join(letter for letter in attributes if letter.isalpha())
    element = f'<test type="gtest"{attributes}>{program}</test>'
    return passing(bench, suite.write(bench, name, [element]))


def counted(seconds: Callable[[int], float]) -> Samples:
    """The time of a program with one case, and that of each further one."""
    one, some, many = (seconds(count) for count in (1, COUNT, LARGE_COUNT))
    return {FIRST: [one * 1e3], FURTHER: [(many - some) * 1e6 / (LARGE_COUNT - COUNT)]}


def bare_counted(bench: Bench, count: int) -> float:
    """Runs the program alone with so many cases."""
    settings = {"BENCH_CASES": str(count)}
    return bench.launch([str(bench.directory / "gtest-counted")], settings=settings).seconds


def rtf_counted(bench: Bench, count: int) -> float:
    """Runs it with rtf."""
    elements = [
        f'<env name="BENCH_CASES" value="{count}"/>',
        '<test type="gtest">gtest-counted</test>',
    ]
    with suite.Run(bench, suite.write(bench, f"gtest-{count}", elements)) as run:
        run.expect("case-finished", count, '"verdict":"passed"')
        return run.launched.seconds


def rtf_pytest(bench: Bench) -> Callable[[], Samples]:
    """Runs the functions with rtf, in the environment that has pytest."""
    interpreter = Path(bench.pytest).with_name("python")
    elements = [
        f'<env name="RTF_PYTHON" value="{interpreter}"/>',
        '<test type="pytest" param="-q -p no:cacheprovider">functions</test>',
    ]
    return passing(bench, suite.write(bench, "pytest", elements))


def passing(bench: Bench, file: Path) -> Callable[[], Samples]:
    """Runs a suite in which all cases pass."""

    def work() -> Samples:
        with suite.Run(bench, file) as run:
            run.expect("case-finished", COUNT, '"verdict":"passed"')
            return a_case(run.launched)

    return work


def pytest(bench: Bench) -> Callable[[], Samples]:
    """Runs the functions with pytest alone, without its cache."""
    directory = bench.directory / "functions"
    directory.mkdir(exist_ok=True)
    functions = "".join(f"def test_{n:06}():\n    assert True\n\n\n" for n in range(COUNT))
    (directory / "test_trivial.py").write_text(functions, encoding="utf-8")
    command = [bench.pytest, "-q", "-p", "no:cacheprovider", str(directory)]

    def work() -> Samples:
        launched = bench.launch(command)
        if f"{COUNT} passed" not in launched.output:
            raise MeasuringError(f"pytest did not pass {COUNT} tests:\n{launched.output}")
        return a_case(launched)

    return work


def ctest(bench: Bench, program: str) -> Callable[[], Samples]:
    """Runs a process for each case with ctest, as `gtest_discover_tests` of CMake does."""
    directory = bench.directory / "ctest-gtest"
    directory.mkdir(exist_ok=True)
    entries = "".join(
        f'add_test("Many.Case{n}" "{program}" "--gtest_filter=Many.Case{n}")\n'
        for n in range(COUNT)
    )
    (directory / "CTestTestfile.cmake").write_text(entries, encoding="utf-8")
    return lambda: a_case(bench.launch([bench.ctest, "--test-dir", str(directory)]))


def a_case(launched: Launched) -> Samples:
    """The time per case."""
    return {UNIT: [launched.seconds * 1e3 / COUNT]}
