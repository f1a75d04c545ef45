"""Runs tests in simulated time with real middleware; the clock runs, pauses, or is killed.

The simulator is a process of ROS 1, ROS 2 or YARP that sends only the time.
"""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest
from checkout import ROOT
from processes import MARK, commands, select
from run import Run, expect, is_a
from sources import each_source

pytestmark = pytest.mark.usefixtures("home")
SUITES = ROOT / "tests/fixtures/clock"
SLOW = ("--set=speed=0.2", "--set=seconds=0.2")
FOLLOWERS = {"ros": "RosTime", "ros2": "Ros2Time", "yarp": "YarpTime"}
"""The tests that compare the times."""


@each_source
def test_limits_are_in_simulated_time(rtf: str, tmp_path: Path, source: str) -> None:
    """A simulated limit of eight seconds takes less than eight seconds of wall time."""
    run = start(rtf, source, tmp_path)
    finish(run, {"Pause": "timed-out", FOLLOWERS[source]: "passed"})
    expect_reason(run, "run did not end within 8s of simulated time, which took ")


@each_source
def test_a_paused_clock_ends_a_wait(rtf: str, tmp_path: Path, source: str) -> None:
    run = start(rtf, source, tmp_path, *SLOW)
    disturb(run, signal.SIGSTOP)
    run.wait_for(lambda event: is_a(event, "test-stopping"))
    for pid in simulators():
        os.kill(pid, signal.SIGCONT)
    finish(run, {"Pause": "timed-out", FOLLOWERS[source]: "passed"})
    reason = "run did not end within 8s of simulated time, nor within 8s: the clock "
    expect_reason(run, reason)


@each_source
def test_a_lost_clock_is_a_collapse(rtf: str, tmp_path: Path, source: str) -> None:
    """After a restart, tests follow it again."""
    run = start(rtf, source, tmp_path, *SLOW)
    disturb(run, signal.SIGKILL)
    if source == "ros2":
        # For 20 s, ROS treats a killed node like a silent one.
        finish(run, {"Pause": "timed-out", FOLLOWERS[source]: "passed"})
        return
    finish(run, {"Pause": "collapsed", FOLLOWERS[source]: "passed"})
    reason = run.reason()
    expect(f"lost in {reason!r}", reason.startswith("the simulated time is lost: "), True)


def start(rtf: str, source: str, directory: Path, *options: str) -> Run:
    """Starts a run."""
    return Run(rtf, str(SUITES / f"{source}.xml"), directory / "results", *options)


def disturb(run: Run, number: signal.Signals) -> None:
    """Sends a signal to the simulator while the first test waits."""

    def send() -> None:
        (simulator,) = simulators()
        os.kill(simulator, number)

    run.disturb(send)


def finish(run: Run, verdicts: dict[str, str]) -> None:
    """Waits until the run ends; no process is left."""
    expect("exit code", run.wait(), 1)
    expect("verdicts", run.verdicts(), verdicts)
    expect("processes left", commands(processes()), [])


def expect_reason(run: Run, expected: str) -> None:
    """The waiting test ended with this reason."""
    reason = run.reason("test-stopping")
    expect(f"`{expected}` in {reason!r}", reason.startswith(expected), True)


def simulators() -> list[int]:
    """The simulator, without the process that runs it."""
    return processes("_simulator.py", unless="keeper.py")


def processes(word: str = "", unless: str = "\0") -> list[int]:
    """The processes of the run whose command line contains a word, without zombies."""
    mark = f"{MARK}={os.environ[MARK]}"
    return select(
        lambda _, words, variables: (
            mark in variables and word in " ".join(words) and unless not in " ".join(words)
        )
    )
