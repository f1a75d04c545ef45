#!/usr/bin/env python3
"""Runs rtf for a long time and checks that what it uses does not grow.

    soak.py RTF [--minutes N] [--runs N]

First, a run of two parallel suites for some minutes, which a browser shows: tests pass, fail and
kill their fixture, hooks run, and the history is on. Then `rtf serve`, which a browser shows, while
many short runs are added to its results. During both, memory, descriptors, threads and zombies of
rtf's processes, and the number of temporary files, are measured twice a second. The Mann-Kendall
test decides whether a value grows, after the first fifth, in which caches fill. Needs the packages
of tools/requirements-soak.txt.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pymannkendall
from processes import children

ROOT = Path(__file__).resolve().parent.parent
INTERVAL = 0.5
# A value grows if the test is this sure, and the growth over the whole time is beyond the noise.
CONFIDENCE = 0.001
NOISE = {"memory": 2.0, "descriptors": 3.0, "threads": 2.0, "zombies": 1.0, "files": 3.0}
# Passed tests for each collapse. Between collapses that are less than 30 s apart, the delay of the
# restart grows to 10 s, in which no test runs.
SHARED, OWN = 1800, 600
# The results of a run stay in memory until its reports are written, and what the page lists.
BYTES_A_TEST = 1536
# The page's server keeps a summary of each run.
BYTES_A_RUN = 1024

PASS = 'function TestCase.run() rtf.check(true, "it moves") end\n'
FAIL = 'function TestCase.run() rtf.fail("it does not move") end\n'
KILL = """function TestCase.run()
  os.execute("kill -9 $(cat " .. os.getenv("SIMULATOR") .. ")")
  rtf.sleep(10)
end
"""
SUITE = """<suite name="{name}" tolerate-collapse="true">
  <env name="SIMULATOR" value="{name}.pid"/>
  <fixture name="simulator" type="process" restarts="1000000" restart-delay="1ms">
    <command>sh -c 'echo $$ > {name}.pid; echo ready; exec sleep 100000'</command>
    <ready log="ready"/>
  </fixture>
  <hook on="failure collapse" name="park"><command>true</command></hook>
  <test isolation="shared" repetition="{shared}">pass.lua</test>
  <test name="own" repetition="{own}">pass.lua</test>
  <test>fail.lua</test>
  <test>kill.lua</test>
</suite>
"""
SHORT = """<suite name="short">
  <test isolation="shared" repetition="19">pass.lua</test>
  <test name="own">pass.lua</test>
</suite>
"""


@dataclass
class Use:
    """What the processes use at a moment."""

    memory: float
    """Private memory of rtf, in MiB."""
    descriptors: int
    threads: int
    zombies: int
    files: int
    """Entries of the directory of temporary files."""


def main() -> int:
    """Runs both parts and prints a table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("rtf", type=Path)
    parser.add_argument("--minutes", type=float, default=8)
    parser.add_argument("--runs", type=int, default=5000)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="rtf-soak-") as name:
        bench = Bench(options.rtf.resolve(), Path(name))
        problems = one_run(bench, options.minutes) + many_runs(bench, options.runs)
    for problem in problems:
        print(f"FAILED: {problem}")
    return 1 if problems else 0


class Bench:
    """A directory with suites, results and temporary files."""

    def __init__(self, rtf: Path, directory: Path) -> None:
        self.rtf, self.directory = rtf, directory
        self.temporary = directory / "temporary"
        self.temporary.mkdir()
        for name, text in {"pass": PASS, "fail": FAIL, "kill": KILL}.items():
            (directory / f"{name}.lua").write_text(text)
        for name in ("arm", "hand"):
            (directory / f"{name}.xml").write_text(SUITE.format(name=name, shared=SHARED, own=OWN))
        (directory / "short.xml").write_text(SHORT)
        self.environment = {**os.environ, "TMPDIR": str(self.temporary)}

    @contextmanager
    def started(self, output: Path, *args: str) -> Iterator[subprocess.Popen[bytes]]:
        """Starts rtf, and ends it if it is still there at the end."""
        process = self.start(output, *args)
        try:
            yield process
        finally:
            process.terminate()
            process.wait()

    def start(self, output: Path, *args: str) -> subprocess.Popen[bytes]:
        """Starts rtf in the directory."""
        with output.open("wb") as file:
            return subprocess.Popen(
                [str(self.rtf), *args],
                cwd=self.directory,
                env=self.environment,
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=subprocess.STDOUT,
            )


def one_run(bench: Bench, minutes: float) -> list[str]:
    """A long run of parallel suites."""
    output = bench.directory / "run.log"
    limit = f"{round(minutes * 60)}s"
    options = ["--jobs", "2", "--web=127.0.0.1:0", "--for", limit]
    with (
        bench.started(output, "run", *options, "arm.xml", "hand.xml") as process,
        browser(address(process, output)),
        Meter(bench, process.pid) as meter,
    ):
        code = process.wait()
    journal = bench.directory / "rtf-results" / "latest" / "events.jsonl"
    verdicts: Counter[str] = Counter()
    with journal.open(encoding="utf-8") as lines:
        for line in lines:
            event = json.loads(line)
            if event["type"] == "test-finished":
                verdicts[event["verdict"]] += 1
    tests = verdicts.total()
    size = journal.stat().st_size / 1e6
    print(f"one run: {tests} tests, {dict(verdicts)}, journal {size:.0f} MB", flush=True)
    rounds = verdicts["failed"]
    wanted = {"passed": (SHARED + OWN) * rounds, "failed": rounds, "collapsed": rounds}
    problems = [] if code == 1 else [f"exit code {code} of the run"]
    if verdicts != wanted:
        problems.append(f"the verdicts are {dict(verdicts)}, not {wanted}")
    shown = bench.start(bench.directory / "show.log", "show", "latest")
    if shown.wait() != 1:
        problems.append(f"exit code {shown.returncode} of rtf show")
    return problems + meter.judge("one run", BYTES_A_TEST * tests / 2**20)


def many_runs(bench: Bench, runs: int) -> list[str]:
    """`rtf serve` while runs are added."""
    output = bench.directory / "serve.log"
    # The page shows a search among several runs.
    for _ in range(2):
        bench.start(bench.directory / "short.log", "run", "short.xml").wait()
    problems = []
    with (
        bench.started(output, "serve", "--web=127.0.0.1:0") as server,
        browser(address(server, output)),
        Meter(bench, server.pid) as meter,
    ):
        for number in range(runs):
            run = bench.start(bench.directory / "short.log", "run", "short.xml")
            if run.wait() != 0:
                problems.append(f"exit code {run.returncode} of run {number}")
                break
    print(f"rtf serve: {runs} runs of 20 tests")
    return problems + meter.judge("rtf serve", BYTES_A_RUN * runs / 2**20)


def address(process: subprocess.Popen[bytes], output: Path) -> str:
    """The address that rtf prints."""
    while process.poll() is None:
        found = re.search(r"http://\S+(?=\s)", output.read_text(errors="replace"))
        if found:
            return found[0]
        time.sleep(0.01)
    raise SystemExit(f"error: rtf ended:\n{output.read_text(errors='replace')}")


@contextmanager
def browser(url: str) -> Iterator[None]:
    """A browser that shows the page."""
    node = run_tool("node.sh").strip()
    run_tool("web.sh", "modules")
    command = [f"{node}/node", str(ROOT / "web" / "tests" / "watch.mjs"), url]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as viewer:
        if viewer.stdout is None or viewer.stdout.readline() != "open\n":
            raise SystemExit("error: the browser did not open the page")
        yield


def run_tool(name: str, *args: str) -> str:
    """Runs a script of this directory; returns its output."""
    command = [str(ROOT / "tools" / name), *args]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


class Meter:
    """Measures in the background what a process of rtf and its runner use."""

    def __init__(self, bench: Bench, pid: int) -> None:
        self.bench, self.pid = bench, pid
        self.uses: list[Use] = []
        self.ended = threading.Event()
        self.thread = threading.Thread(target=self.measure)

    def __enter__(self) -> Meter:
        """Starts."""
        self.thread.start()
        return self

    def __exit__(self, *problem: object) -> None:
        """Ends."""
        self.close()

    def close(self) -> None:
        """Ends the measurement."""
        self.ended.set()
        self.thread.join()

    def measure(self) -> None:
        """Measures until the end."""
        while not self.ended.wait(INTERVAL):
            try:
                self.uses.append(self.use())
            except OSError:  # it has ended
                return

    def use(self) -> Use:
        """What is used now."""
        own = [self.pid, *(child for child in children(self.pid) if name(child) == "rtf")]
        return Use(
            memory=sum(private_memory(pid) for pid in own),
            descriptors=sum(entries(pid, "fd") for pid in own),
            threads=sum(entries(pid, "task") for pid in own),
            zombies=zombies(self.pid),
            files=sum(1 for _ in self.bench.temporary.iterdir()),
        )

    def judge(self, what: str, growth_of_memory: float = 0.0) -> list[str]:
        """Prints a row for each value. Returns those that grow by more than the noise, and the
        memory by more than this many MiB.
        """
        settled = self.uses[len(self.uses) // 5 :]
        problems = []
        for value, noise in NOISE.items():
            series = [float(getattr(use, value)) for use in settled]
            trend = pymannkendall.original_test(series, alpha=CONFIDENCE)
            growth = trend.slope * len(series)
            allowed = noise + growth_of_memory if value == "memory" else noise
            grows = trend.trend == "increasing" and growth > allowed
            print(
                f"  {value:<12} {series[0]:8.1f} to {series[-1]:8.1f}, at most {max(series):8.1f}; "
                f"Mann-Kendall p = {trend.p:.3f}, Theil-Sen {growth:+.2f} "
                f"(allowed {allowed:.1f}): {'GROWS' if grows else 'ok'}"
            )
            if grows:
                problems.append(f"{what}: {value} grow by {growth:.1f}")
        return problems


def entries(pid: int, kind: str) -> int:
    """How many entries a directory of a process in /proc has."""
    return sum(1 for _ in Path(f"/proc/{pid}/{kind}").iterdir())


def name(pid: int) -> str:
    """The name of a process."""
    try:
        return Path(f"/proc/{pid}/comm").read_text().strip()
    except OSError:
        return ""


def private_memory(pid: int) -> float:
    """In MiB."""
    text = Path(f"/proc/{pid}/smaps_rollup").read_text()
    return sum(int(size) for size in re.findall(r"^Private_\w+: +(\d+) kB$", text, re.M)) / 1024


def zombies(pid: int) -> int:
    """How many descendants have ended and were not waited for."""
    found = 0
    for child in children(pid):
        try:
            state = Path(f"/proc/{child}/stat").read_text().rpartition(")")[2].split()[0]
            found += state == "Z"
            found += zombies(child)
        except OSError:
            continue
    return found


if __name__ == "__main__":
    sys.exit(main())
