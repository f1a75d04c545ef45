"""A plan of 100 000 tests: the runner's time and memory."""

from __future__ import annotations

from pathlib import Path

from measuring import suite
from measuring.bench import Bench
from measuring.model import Group, Limit, Line, Samples, Work

COUNT = 100_000
SECONDS = "s"
MEMORY = "MB"

CHECK = "rtf check"
RUN = "rtf run"
JUNIT = "rtf report --format junit"


def group(bench: Bench) -> Group:
    """The first test is critical and fails; the rest is skipped."""
    critical = '<test name="critical" critical="true">Fails</test>'
    file = suite.write(bench, "large", [critical, *suite.tests("dll", "Trivial", COUNT - 1)])
    works = (
        Work(CHECK, lambda: check(bench, file)),
        Work(RUN, lambda: run(bench, file)),
        Work(JUNIT, lambda: junit(bench, file)),
    )
    name = f"{COUNT:,}".replace(",", " ") + " planned tests"
    memory = Limit(250)
    lines = (
        Line(f"{name}, memory of rtf check", CHECK, MEMORY, limit=memory),
        Line(f"{name}, memory of rtf run", RUN, MEMORY, limit=memory),
        Line(f"{name}, memory of rtf run: goal", RUN, MEMORY, limit=Limit(200, required=False)),
        Line(f"{name}, rtf check", CHECK, SECONDS, limit=Limit(1, required=False)),
        Line(f"{name}, rtf run that skips them", RUN, SECONDS),
        Line(f"{name}, JUnit written", JUNIT, SECONDS, limit=Limit(2, required=False)),
        Line(f"{name}, memory of the JUnit report", JUNIT, MEMORY, limit=memory),
    )
    return Group("large", works, lines, rounds=3, warm_up=False)


def check(bench: Bench, file: Path) -> Samples:
    """Plans; starts only the host that checks the plug-ins."""
    launched = bench.launch([str(bench.rtf), "check", str(file)])
    return {SECONDS: [launched.seconds], MEMORY: [launched.children[0].rss_mb]}


def run(bench: Bench, file: Path) -> Samples:
    """Plans, runs one, skips the rest."""
    with suite.Run(bench, file, codes=(1,)) as run:
        run.expect("test-finished", 1, '"verdict":"failed"')
        run.expect("test-skipped", COUNT - 1)
        launched = run.launched
    return {SECONDS: [launched.seconds], MEMORY: [launched.children[0].rss_mb]}


def junit(bench: Bench, file: Path) -> Samples:
    """Writes the report from the journal of such a run."""
    report = bench.directory / "junit.xml"
    with suite.Run(bench, file, codes=(1,)) as run:
        command = [str(bench.rtf), "report", str(run.directory), "--format", "junit"]
        launched = bench.launch([*command, "--output", str(report)])
    suite.expect_in(report, COUNT, "<testcase ")
    return {SECONDS: [launched.seconds], MEMORY: [launched.children[0].rss_mb]}
