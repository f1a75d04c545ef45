"""The time from a fixture's death until the running test is asked to stop.

The test itself kills the fixture's process and measures the time, so there is only one
clock. The runner's share, from detecting the collapse to asking the test, is in the
journal.
"""

from __future__ import annotations

from pathlib import Path

from measuring import suite
from measuring.bench import Bench
from measuring.model import Group, Limit, Line, MeasuringError, Samples, Work, high_percentile

COUNT = 60
"""Collapses in each round."""

LATENCY = "ms"
NOTICE = "µs"

PROCESS = "process"
PLUGIN = "plug-in"


def group(bench: Bench) -> Group:
    """A program that is a fixture, and a fixture plug-in whose host is killed."""
    pid = bench.directory / "victim.pid"
    common = 'name="victim" restarts="0"'
    fixtures = {
        PROCESS: (
            f'<fixture type="process" {common}>'
            f'<command>"{bench.directory}/victim" "{pid}"</command><ready log="^ready$"/></fixture>'
        ),
        PLUGIN: f'<fixture type="dll" {common} param=\'"{pid}"\'>../VictimFixture</fixture>',
    }
    works = []
    lines: list[Line] = []
    for kind, fixture in fixtures.items():
        # A suite for each collapse, because the restart delay grows within a suite.
        directory = bench.directory / f"collapse-{kind}"
        directory.mkdir(exist_ok=True)
        for number in range(COUNT):
            test = f"<test param='\"{pid}\"'>../Killer</test>"
            suite.write(bench, f"{directory.name}/{number:02}", [fixture, test])
        works.append(Work(kind, lambda directory=directory: collapses(bench, directory)))  # type: ignore[misc]
        lines += lines_of(kind)
    return Group("collapse", tuple(works), tuple(lines), rounds=3, warm_up=False)


def lines_of(kind: str) -> list[Line]:
    """Median and tail."""
    what = f"{kind} fixture killed → test interrupted"
    median, tail = Limit(5, required=False), Limit(20, required=False)
    return [
        Line(f"{what}, median", kind, LATENCY, limit=median),
        Line(f"{what}, 99 %", kind, LATENCY, limit=tail, statistic=high_percentile),
        Line(f"{what}, collapse noticed → test asked", kind, NOTICE),
    ]


def collapses(bench: Bench, directory: Path) -> Samples:
    """Runs the suites of a directory; in each of them, the fixture dies."""
    with suite.Run(bench, directory, codes=(1,)) as run:
        run.expect("test-finished", COUNT, '"verdict":"collapsed"')
        events = run.events()
    latencies = [latency(event) for event in events if event["type"] == "measured"]
    if len(latencies) != COUNT:
        raise MeasuringError(f"{len(latencies)} latencies were measured, {COUNT} expected")
    return {LATENCY: latencies, NOTICE: notices(events)}


def latency(event: dict[str, object]) -> float:
    """The test's measurement, in milliseconds."""
    measurement = event["measurement"]
    value = measurement["value"] if isinstance(measurement, dict) else None
    if not isinstance(value, float):
        raise MeasuringError(f"not a measurement: {event}")
    return value


def notices(events: list[dict[str, object]]) -> list[float]:
    """Microseconds from each `fixture-collapsed` to the next `test-stopping`."""
    found = []
    since = 0
    for event in events:
        at = event["at"]
        if not isinstance(at, int):
            raise MeasuringError(f"no time: {event}")
        if event["type"] == "fixture-collapsed":
            since = at
        elif event["type"] == "test-stopping":
            found.append(float(at - since))
    return found
