"""Signals and monitors: how fast a violation stops a test, and what recording costs.

The test writes the violating sample itself and measures the time until it is asked to stop, so
there is only one clock. A second program, `cat`, copies the sample to the recorder.
"""

from __future__ import annotations

import os
from collections import defaultdict
from pathlib import Path

from measuring import suite
from measuring.bench import Bench
from measuring.model import Group, Limit, Line, MeasuringError, Samples, Work, high_percentile

COUNT = 60
"""Violations in each round."""

SIGNALS = 50
RATE_HZ = 1000
SECONDS = int(os.environ.get("RTF_BENCH_SIGNAL_SECONDS", "60"))
"""A shorter time is for trying the measurement: the rows of the page are for 60 s."""

MISSING_LINES = 0.01
"""How much fewer lines the source may write than its rate says, on a busy machine."""

LATENCY = "ms"
PROCESSOR = "%"
MEMORY = "MB"

VIOLATION = "violation"
RECORDING = "recording"


def group(bench: Bench) -> Group:
    """A monitor that stops tests, and many signals."""
    fifo = bench.directory / "samples"
    if not fifo.exists():
        os.mkfifo(fifo)
    works = (
        Work(VIOLATION, lambda: violations(bench, stopping(bench, fifo))),
        Work(RECORDING, lambda: recording(bench, many(bench))),
    )
    what = f"{SIGNALS} signals at {RATE_HZ} Hz for {SECONDS} s"
    median = tail = Limit(5, required=False)
    lines = (
        Line("sample → test asked to stop, median", VIOLATION, LATENCY, limit=median),
        Line(
            "sample → test asked to stop, 99 %",
            VIOLATION,
            LATENCY,
            limit=tail,
            statistic=high_percentile,
        ),
        Line(
            f"{what}: recorder, of one core", RECORDING, PROCESSOR, limit=Limit(20, required=False)
        ),
        Line(f"{what}: recorder, memory", RECORDING, MEMORY),
        Line(f"{what}: runner, of one core", RECORDING, f"runner {PROCESSOR}"),
        Line(f"{what}: runner, memory", RECORDING, f"runner {MEMORY}"),
    )
    return Group("signals", works, lines, rounds=1, warm_up=False)


def stopping(bench: Bench, fifo: Path) -> Path:
    """A suite of tests that a monitor stops."""
    copy = f"""<command>sh -c 'exec cat 0&lt;&gt;"$0"' "{fifo}"</command>"""
    signal = f'<signal name="q" time="arrival" wait="false">{copy}</signal>'
    monitor = '<monitor name="low" severity="stop">always(q &lt; 0.5)</monitor>'
    test = f'<test type="python" param="{fifo}" repetition="{COUNT}">Violator</test>'
    return suite.write(bench, "violations", [signal, monitor, test])


def violations(bench: Bench, file: Path) -> Samples:
    """Each test is stopped once."""
    with suite.Run(bench, file, codes=(1,)) as run:
        run.expect("test-stopping", COUNT, '"cause":"finding"')
        latencies = measured(run.events())["latency"]
    if len(latencies) != COUNT:
        raise MeasuringError(f"{len(latencies)} latencies were measured, {COUNT} expected")
    return {LATENCY: latencies}


def many(bench: Bench) -> Path:
    """A suite with many signals, one of which counts, and a monitor."""
    names = "".join(f'<signal name="s{number}"/>' for number in range(1, SIGNALS))
    rows = f'"{bench.directory}/signal_rows.py" {SIGNALS} {RATE_HZ}'
    signals = f'<signals><command>python3 {rows}</command><signal name="count"/>{names}</signals>'
    monitor = '<monitor name="low">always(s1 &lt; 2)</monitor>'
    test = f'<test type="python" param="{SECONDS}">SignalLoad</test>'
    return suite.write(bench, "many", [signals, monitor, test])


def recording(bench: Bench, file: Path) -> Samples:
    """No sample may be lost."""
    with suite.Run(bench, file) as run:
        events = run.events()
    points: dict[str, list[tuple[float, float]]] = defaultdict(list)
    for event in events:
        samples = event.get("samples")
        if isinstance(samples, dict):
            points[samples["name"]] += [tuple(point) for point in samples["points"]]
    expect_complete(points)
    values = measured(events)
    return {
        PROCESSOR: values["recorder, processor"],
        MEMORY: values["recorder, memory"],
        f"runner {PROCESSOR}": values["runner, processor"],
        f"runner {MEMORY}": values["runner, memory"],
    }


def expect_complete(points: dict[str, list[tuple[float, float]]]) -> None:
    """Checks that each line of the source has arrived, and that it has written enough."""
    counts = [count for _, count in points["count"]]
    if counts != [counts[0] + index for index in range(len(counts))]:
        raise MeasuringError("samples were lost")
    lengths = {len(samples) for samples in points.values()}
    if len(points) != SIGNALS or lengths != {len(counts)}:
        raise MeasuringError(f"{len(points)} signals have {lengths} samples, not {len(counts)}")
    if len(counts) < (1 - MISSING_LINES) * SECONDS * RATE_HZ:
        raise MeasuringError(f"the source wrote only {len(counts)} lines: the machine is too busy")


def measured(events: list[dict[str, object]]) -> dict[str, list[float]]:
    """The values of all measurements, by name."""
    values: dict[str, list[float]] = defaultdict(list)
    for event in events:
        measurement = event.get("measurement")
        if isinstance(measurement, dict):
            values[measurement["name"]].append(float(measurement["value"]))
    return values
