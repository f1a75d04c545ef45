"""Checks that the verdicts of a suite do not change because the machine is slow.

The same suite runs undisturbed, while others use all processors, with results on a slow disk, and
with little memory that others want too. Needs `stress-ng`, `bindfs` and root.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from checkout import need_packages

# They would disturb each other.
pytestmark = [pytest.mark.first, pytest.mark.xdist_group("degraded")]
# Bytes per second: the journal of the suite needs about ten seconds.
SLOW_DISK = "20k"
MEMORY = 192 * 2**20
# A collapse is noticed by the kernel's message, also if the processors and the disk are slow.
COLLAPSE_SECS = 1.0
MEMORY_GROUPS = Path("/sys/fs/cgroup/memory")

LUA = {
    "pass": 'function TestCase.run() rtf.check(true, "it moves") end\n',
    "fail": 'function TestCase.run() rtf.fail("it does not move") end\n',
    "exit": "function TestCase.run() os.exit(0) end\n",
    "kill": """function TestCase.run()
  os.execute("kill -9 $(cat simulator.pid)")
  rtf.sleep(60)
end
""",
}
PYTHON = """import rtf


class Cases(rtf.TestCase):
    def run(self):
        for number in range(20):
            with self.case(f"pose {number}"):
                self.check(number != 7, "the pose is reached")
"""
SUITE = """<suite name="arm" tolerate-collapse="true">
  <fixture name="simulator" type="process">
    <command>sh -c 'echo $$ > simulator.pid; echo ready; exec sleep 1000'</command>
    <ready log="ready"/>
  </fixture>
  <test isolation="shared" repetition="180">pass.lua</test>
  <test name="own" repetition="60">pass.lua</test>
  <test>fail.lua</test>
  <test>cases.py</test>
  <test>exit.lua</test>
  <test>kill.lua</test>
  <test name="last">pass.lua</test>
</suite>
"""
EXPECTED = {
    "pass": "passed",
    "own": "passed",
    "fail": "failed",
    "cases": "failed",
    "exit": "crashed",
    "kill": "collapsed",
    "last": "passed",
}


class Bench:
    """A directory with the suite."""

    def __init__(self, rtf: str, directory: Path) -> None:
        self.rtf, self.directory = rtf, directory
        for name, text in LUA.items():
            (directory / f"{name}.lua").write_text(text)
        (directory / "cases.py").write_text(PYTHON)
        (directory / "arm.xml").write_text(SUITE)

    def run(self, results: str, *before: str) -> str:
        """Runs the suite, checks its results, and returns what was printed."""
        command = [*before, self.rtf, "run", "--no-history", "--results", results, "arm.xml"]
        done = subprocess.run(
            command, cwd=self.directory, capture_output=True, text=True, check=False
        )
        printed = done.stdout + done.stderr
        assert done.returncode == 1, f"exit code {done.returncode}\n{printed}"
        self.check(self.directory / results / "latest" / "events.jsonl", printed)
        return printed

    def check(self, journal: Path, printed: str) -> None:
        """Compares the verdicts, and the time from the collapse to the end of the test."""
        events = [json.loads(line) for line in journal.read_text().splitlines()]
        names = {it["test"]: it["name"] for it in events if it["type"] == "test-planned"}
        ends = [it for it in events if it["type"] == "test-finished"]
        found = {names[it["test"]]: it["verdict"] for it in ends}
        assert found == EXPECTED, f"{found} is not {EXPECTED}\n{printed}"
        assert len(ends) == len(EXPECTED) + 179 + 59, f"{len(ends)} results"
        failed = [it for it in events if it["type"] == "case-finished" and "reason" in it]
        assert len(failed) == 1, f"{failed} is not one case"
        collapse, end = moment(events, "fixture-collapsed"), moment(events, "test-stopping")
        assert end - collapse < COLLAPSE_SECS, f"the test ran on for {end - collapse} s"


@pytest.fixture
def bench(rtf: str, tmp_path: Path) -> Bench:
    """A directory with the suite."""
    need_packages("stress-ng", "bindfs")
    return Bench(rtf, tmp_path)


def moment(events: list[dict[str, Any]], kind: str) -> float:
    """When the only event of a kind occurred, in seconds."""
    [event] = [it for it in events if it["type"] == kind]
    return float(event["at"]) / 1e6


def test_verdicts_without_disturbance(bench: Bench) -> None:
    """Nothing is slow, and nothing is said about it."""
    printed = bench.run("undisturbed")
    assert "not yet written" not in printed, printed


def test_verdicts_while_others_use_all_processors(bench: Bench) -> None:
    """Four times as many busy processes as processors."""
    with stress("--cpu", str(4 * (os.cpu_count() or 1))):
        bench.run("busy")


def test_verdicts_with_results_on_a_slow_disk(bench: Bench) -> None:
    """The results are on a disk that writes 20 kB a second, which is said."""
    source, disk = bench.directory / "source", bench.directory / "disk"
    source.mkdir()
    disk.mkdir()
    command = ["bindfs", f"--write-rate={SLOW_DISK}", "-f", str(source), str(disk)]
    with subprocess.Popen(command) as server:
        try:
            until("the disk is there", lambda: os.path.ismount(disk))
            printed = bench.run("disk/results")
            assert "not yet written: the disk with `disk/results/" in printed, printed
        finally:
            subprocess.run(["umount", "--lazy", str(disk)], check=True)
            server.wait()


def test_verdicts_with_little_memory(bench: Bench) -> None:
    """The run shares a group of 192 MiB with processes that want more than that."""
    group = MEMORY_GROUPS / f"rtf-degraded-{os.getpid()}"
    limit = "memory.limit_in_bytes"
    if not (MEMORY_GROUPS / limit).exists():
        group, limit = Path("/sys/fs/cgroup") / group.name, "memory.max"
    group.mkdir()
    try:
        (group / limit).write_text(str(MEMORY))
        join = ["sh", "-c", f'echo $$ > {group}/cgroup.procs; exec "$@"', "sh"]
        # Its processes, and none of rtf's, are killed when there is no memory.
        with stress("--vm", "2", "--vm-bytes", str(MEMORY), before=join):
            bench.run("memory", *join)
        assert was_scarce(group), "the memory was not scarce"
    finally:
        until("the group is empty", lambda: not (group / "cgroup.procs").read_text())
        group.rmdir()


def was_scarce(group: Path) -> bool:
    """Whether a group's memory reached its limit."""
    failures = group / "memory.failcnt"
    if failures.exists():
        return int(failures.read_text()) > 0
    return re.search(r"^max [1-9]", (group / "memory.events").read_text(), re.M) is not None


@contextmanager
def stress(*options: str, before: list[str] | None = None) -> Iterator[None]:
    """Runs `stress-ng` meanwhile."""
    command = [*(before or []), "stress-ng", "--quiet", "--timeout", "600", *options]
    with subprocess.Popen(command, start_new_session=True, stderr=subprocess.DEVNULL) as process:
        try:
            time.sleep(1)
            assert process.poll() is None, "stress-ng ended"
            yield
        finally:
            os.killpg(process.pid, signal.SIGTERM)


def until(what: str, is_true: Callable[[], bool]) -> None:
    """Waits for something."""
    deadline = time.monotonic() + 60
    while not is_true():
        assert time.monotonic() < deadline, f"after a minute: not {what}"
        time.sleep(0.02)
