"""A plan of 100 000 tests: the runner's time and memory, and how both grow."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from measuring import suite
from measuring.bench import Bench, Launched
from measuring.model import Group, Limit, Line, Samples, Work

COUNT = 100_000
COUNTS = (1000, 10_000, COUNT)
SECONDS = "s"
MEMORY = "MB"
GROWTH = "times the cost of a further test, at 100 000 to 10 000"

CHECK = "rtf check"
RUN = "rtf run"
JUNIT = "rtf report --format junit"


def group(bench: Bench) -> Group:
    """The first test is critical and fails; the rest is skipped."""
    critical = '<test name="critical" critical="true">Fails</test>'
    files = {
        count: suite.write(
            bench, f"large-{count}", [critical, *suite.tests("dll", "Trivial", count - 1)]
        )
        for count in COUNTS
    }
    works = (
        Work(CHECK, lambda: growing(lambda count: check(bench, files[count]))),
        Work(RUN, lambda: growing(lambda count: run(bench, files[count], count))),
        Work(JUNIT, lambda: growing(lambda count: junit(bench, files[count], count))),
    )
    name = f"{COUNT:,}".replace(",", " ") + " planned tests"
    memory = Limit(250)

    def goal(bound: float) -> Limit:
        return Limit(bound, required=False)

    lines = (
        Line(f"{name}, memory of rtf check", CHECK, MEMORY, limit=memory),
        Line(f"{name}, memory of rtf run", RUN, MEMORY, limit=memory),
        Line(f"{name}, memory of the JUnit report", JUNIT, MEMORY, limit=memory),
        Line(f"{name}, memory of rtf check: goal", CHECK, MEMORY, limit=goal(150)),
        Line(f"{name}, memory of rtf run: goal", RUN, MEMORY, limit=goal(150)),
        Line(f"{name}, memory of the JUnit report: goal", JUNIT, MEMORY, limit=goal(150)),
        Line(f"{name}, rtf check", CHECK, SECONDS, limit=goal(0.2)),
        Line(f"{name}, rtf run that skips them", RUN, SECONDS, limit=goal(0.5)),
        Line(f"{name}, JUnit written", JUNIT, SECONDS, limit=goal(0.5)),
        Line(f"{name}, growth of rtf check", CHECK, GROWTH, limit=goal(1.25)),
        Line(f"{name}, growth of rtf run", RUN, GROWTH, limit=goal(1.25)),
        Line(f"{name}, growth of the JUnit report", JUNIT, GROWTH, limit=goal(1.25)),
    )
    return Group("large", works, lines, rounds=5, warm_up=False)


def growing(measured: Callable[[int], Launched]) -> Samples:
    """Time and memory of the largest number, and the ratio of two slopes: 1 if time is linear."""
    launched = [measured(count) for count in COUNTS]
    short, medium, long = (one.seconds for one in launched)
    low, middle, high = COUNTS
    growth = (long - medium) / (high - middle) / ((medium - short) / (middle - low))
    return {SECONDS: [long], MEMORY: [launched[-1].children[0].rss_mb], GROWTH: [growth]}


def check(bench: Bench, file: Path) -> Launched:
    """Plans; starts only the host that checks the plug-ins."""
    return bench.launch([str(bench.rtf), "check", str(file)])


def run(bench: Bench, file: Path, count: int) -> Launched:
    """Plans, runs one, skips the rest."""
    with suite.Run(bench, file, codes=(1,)) as run:
        run.expect("test-finished", 1, '"verdict":"failed"')
        run.expect("test-skipped", count - 1)
        return run.launched


def junit(bench: Bench, file: Path, count: int) -> Launched:
    """Writes the report from the journal of such a run."""
    report = bench.directory / "junit.xml"
    with suite.Run(bench, file, codes=(1,)) as run:
        command = [str(bench.rtf), "report", str(run.directory), "--format", "junit"]
        launched = bench.launch([*command, "--output", str(report)])
    suite.expect_in(report, count, "<testcase ")
    return launched
