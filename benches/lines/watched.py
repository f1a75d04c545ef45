"""How much a browser that shows the run slows it down."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from measuring import suite
from measuring.bench import TOP, Bench
from measuring.model import Group, Limit, Line, MeasuringError, Samples, Work

from lines import page

COUNT = 300
UNIT = "ms a test"
END_SECS = 120

ALONE = "rtf run without a browser"
WATCHED = "rtf run --web, in a browser"


def group(bench: Bench) -> Group:
    """Tests of 20 ms, which start when the page is open."""
    gate = bench.directory / "gate"
    steps = suite.tests("python", "Steps", COUNT)
    file = suite.write(
        bench, "watched", [f'<test type="python" param="{gate}">Gate</test>', *steps]
    )
    works = (
        Work(ALONE, lambda: alone(bench, file, gate)),
        Work(WATCHED, lambda: watched(bench, file, gate), page.missing()),
    )
    limit = Limit(1.05, of_ratio=True, required=False)
    lines = (Line(f"{COUNT} tests of 20 ms, watched in a browser", WATCHED, UNIT, ALONE, limit),)
    return Group("watched", works, lines, rounds=3)


def alone(bench: Bench, file: Path, gate: Path) -> Samples:
    """The same run without a page."""
    gate.touch()
    with suite.Run(bench, file) as run:
        return {UNIT: [a_test(run.directory)]}


def watched(bench: Bench, file: Path, gate: Path) -> Samples:
    """The tests start when the browser has opened the page."""
    gate.unlink(missing_ok=True)
    with page.started(bench, "run", str(file)) as (process, url), browser(url):
        gate.touch()
        process.wait(END_SECS)
    return {UNIT: [a_test((bench.results / "latest").resolve())]}


@contextmanager
def browser(url: str) -> Iterator[None]:
    """A browser that shows the page."""
    node = page.run([str(TOP / "tools" / "node.sh")]).strip()
    page.run([str(TOP / "tools" / "web.sh"), "modules"])
    script = str(TOP / "web" / "tests" / "watch.mjs")
    command = [f"{node}/node", script, url]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as viewer:
        if viewer.stdout is None or viewer.stdout.readline() != "open\n":
            raise MeasuringError("the browser did not open the page")
        yield


def a_test(directory: Path) -> float:
    """Milliseconds per test, from the end of the gate to the end of the last test."""
    with (directory / "events.jsonl").open(encoding="utf-8") as journal:
        events = [json.loads(line) for line in journal]
    ends = [event["at"] for event in events if event["type"] == "test-finished"]
    passed = sum(event.get("verdict") == "passed" for event in events)
    if passed != COUNT + 1:
        raise MeasuringError(f"{passed} of {COUNT + 1} tests passed")
    return float(ends[-1] - ends[0]) / 1e3 / COUNT
