"""What it costs a run that somebody looks at it in a browser."""

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

ALONE = "rtf run, nobody looks"
WATCHED = "rtf run --web, in a browser"


def group(bench: Bench) -> Group:
    """Tests of some 20 ms, begun when the page is open."""
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
    """The run begins with the look at it."""
    gate.unlink(missing_ok=True)
    with page.started(bench, "run", str(file)) as (process, url), browser(url):
        gate.touch()
        process.wait(END_SECS)
    return {UNIT: [a_test((bench.results / "latest").resolve())]}


@contextmanager
def browser(url: str) -> Iterator[None]:
    """Somebody who looks."""
    node = page.run([str(TOP / "tools" / "node.sh")]).strip()
    page.run([str(TOP / "tools" / "web.sh"), "modules"])
    script = str(TOP / "web" / "tests" / "watch.mjs")
    command = [f"{node}/node", script, url]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as looking:
        if looking.stdout is None or looking.stdout.readline() != "open\n":
            raise MeasuringError("the browser did not open the page")
        yield


def a_test(directory: Path) -> float:
    """Milliseconds a test, from the gate's end to the end of the last one."""
    with (directory / "events.jsonl").open(encoding="utf-8") as journal:
        events = [json.loads(line) for line in journal]
    ends = [event["at"] for event in events if event["type"] == "test-finished"]
    passed = sum(event.get("verdict") == "passed" for event in events)
    if passed != COUNT + 1:
        raise MeasuringError(f"{passed} of {COUNT + 1} tests passed")
    return float(ends[-1] - ends[0]) / 1e3 / COUNT
