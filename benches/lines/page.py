"""The page of runs with 10 000 tests and a million events, and with 100 000 tests, in Chromium."""

from __future__ import annotations

import json
import re
import shutil
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from measuring import suite
from measuring.bench import TOP, Bench
from measuring.model import Group, Limit, Line, MeasuringError, Samples, Work, high_percentile

TESTS = 10_000
EVENTS = 1_000_000
MANY = 100_000
TICKER = "ticker"
END_SECS = 60

OPENED = "ms from nothing to the list"
PAINT = "ms to the list"
LATE = "ms late"
FRAME = "ms a frame"
MEMORY = "MB"

LIVE = "page of a live run"
SERVED = "page of a past run"
LARGE = "page of 100 000 tests"


def group(bench: Bench) -> Group:
    """The page is opened after a million events, while the run continues; then that of others."""
    reports = f'<test type="dll" param="{EVENTS}">Reports</test>'
    ticker = f'<test type="python" name="{TICKER}">Ticker</test>'
    rest = suite.tests("dll", "Trivial", TESTS - 2)
    file = suite.write(bench, "page", [reports, ticker, *rest])
    live = Work(LIVE, lambda: measure_live(bench, file), missing())
    name_of_live = remembered(bench)
    served = Work(SERVED, lambda: measure_served(bench, name_of_live.read_text()), missing())
    critical = '<test name="critical" critical="true">Fails</test>'
    many = suite.write(bench, "page-many", [critical, *suite.tests("dll", "Trivial", MANY - 1)])
    large = Work(LARGE, lambda: measure_large(bench, many), missing())
    name = "10 000 tests, 1 M events"
    smooth, goal = Limit(50, required=False), Limit(1000, required=False)
    lines = (
        Line(f"{name}: the list is drawn", LIVE, PAINT, limit=Limit(1000)),
        Line(f"{name}: event to screen", LIVE, LATE, limit=Limit(200), statistic=high_percentile),
        Line(f"{name}: scrolling", LIVE, FRAME, limit=smooth, statistic=high_percentile),
        Line(f"{name}: rtf serve, the list is drawn again", SERVED, PAINT, limit=Limit(1000)),
        Line(f"{name}: memory of rtf serve", SERVED, MEMORY, limit=Limit(100)),
        Line("100 000 tests: the page is opened", LARGE, OPENED, limit=goal),
        Line("100 000 tests: the list is drawn again", LARGE, PAINT, limit=goal),
        Line("100 000 tests: scrolling", LARGE, FRAME, limit=smooth, statistic=high_percentile),
        Line("100 000 tests: memory of rtf serve", LARGE, MEMORY),
    )
    return Group("page", (live, served, large), lines, rounds=3, warm_up=False)


def missing() -> str:
    """Why the page cannot be measured here; empty if it can."""
    if shutil.which("chromium") or shutil.which("chromium-browser"):
        return ""
    return "Chromium is not installed"


def measure_live(bench: Bench, file: Path) -> Samples:
    """Opens the page while the ticker runs."""
    with started(bench, "run", str(file)) as (_, url):
        found = measure_page(url, TICKER)
    remembered(bench).write_text((bench.results / "latest").resolve().name, encoding="utf-8")
    return {PAINT: found["paint"], LATE: found["lateness"], FRAME: found["frames"]}


def remembered(bench: Bench) -> Path:
    """The file with the name of the run that `measure_live` created."""
    return bench.directory / "page-run"


def measure_served(bench: Bench, name: str) -> Samples:
    """Opens the page of a run that has ended."""
    with started(bench, "serve") as (process, url):
        found = measure_page(f"{url.split('#')[0]}#/runs/{name}", "")
        memory = peak_mb(process.pid)
    names = {"opened": OPENED, "paint": PAINT, "frames": FRAME}
    return {unit: found[name] for name, unit in names.items()} | {MEMORY: [memory]}


def measure_large(bench: Bench, file: Path) -> Samples:
    """Opens the page of a run whose first test fails, so that all others are skipped."""
    with suite.Run(bench, file, codes=(1,)) as run:
        return measure_served(bench, run.directory.name)


@contextmanager
def started(bench: Bench, verb: str, *rest: str) -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    """Starts an rtf with a page: its process and address."""
    command = [str(bench.rtf), verb, "--results", str(bench.results), "--web=127.0.0.1:0", *rest]
    log = bench.directory / "page.log"
    with log.open("wb") as output:
        process = subprocess.Popen(
            command,
            cwd=bench.directory,
            env=bench.environment(),
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=output,
        )
    try:
        yield process, await_address(process, log)
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(END_SECS)


def await_address(process: subprocess.Popen[bytes], log: Path) -> str:
    """Waits until rtf prints the address of its page."""
    while process.poll() is None:
        found = re.search(r"http://\S+(?=\s)", log.read_text(encoding="utf-8", errors="replace"))
        if found is not None:
            return found[0]
    raise MeasuringError(f"rtf ended: {log.read_text(encoding='utf-8', errors='replace')}")


def measure_page(url: str, test: str) -> dict[str, list[float]]:
    """Measures the page in a browser."""
    node = run([str(TOP / "tools" / "node.sh")]).strip()
    run([str(TOP / "tools" / "web.sh"), "modules"])
    script = str(TOP / "web" / "tests" / "measure.mjs")
    found = json.loads(run([f"{node}/node", script, url, test]))
    return {name: value if isinstance(value, list) else [value] for name, value in found.items()}


def run(command: list[str]) -> str:
    """Runs a command; returns its output."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise MeasuringError(f"`{' '.join(command)}` failed:\n{done.stderr}")
    return done.stdout


def peak_mb(pid: int) -> float:
    """The largest resident set of a process so far."""
    status = Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    found = re.search(r"VmHWM:\s+(\d+) kB", status)
    if found is None:
        raise MeasuringError(f"process {pid} has ended")
    return int(found[1]) * 1024 / 1e6
