"""Injects wrong values into the topics and ports of real middleware."""

from __future__ import annotations

import itertools
import math
import os
import statistics
from pathlib import Path

import pytest
from checkout import ROOT
from processes import MARK, children, commands, kill, select
from run import Event, Run, expect, expect_in
from sources import each_source

pytestmark = pytest.mark.usefixtures("home")
Points = list[tuple[float, float]]

# The arm publishes the sine of its time.
RATE_HZ = 100
PERIOD_SECS = 1 / RATE_HZ
# More than it publishes until the end of the test.
MESSAGES = 100_000
# A busy machine delays the arm, the proxy, and the signals.
MARGIN_SECS = 0.2
OFFSET = 10.0
UNKNOWN = {
    "ros": "there is no `ankle` among elbow, wrist",
    "ros2": "`data[7]`",
    "yarp": "has only 2 values",
}
# The offset of the clock in the suite.
JUMP_SECS = -2.0


def suite_of(source: str) -> str:
    """The suite of this name."""
    return str(ROOT / f"tests/fixtures/proxies/{source}.xml")


@each_source
def test_faults_change_the_values_of_messages(rtf: str, tmp_path: Path, source: str) -> None:
    run = Run(rtf, suite_of(source), tmp_path / "results", "--filter", "not name(stay)")
    expect("exit code", run.wait(), 1)
    expect(
        "verdicts",
        run.verdicts(),
        {"right": "passed", "offset": "failed", "injected": "passed", "unknown": "error"},
    )
    relayed(run)
    shifted(run)
    frozen_lossy_and_late(run)
    expect_in(UNKNOWN[source], run.output.read_text())


def relayed(run: Run) -> None:
    """Without a fault, the proxy passes all messages on, as they are."""
    points = signals(run, "right")
    received = [value for _, value in points["elbow"]]
    published = [value for _, value in points["right"]]
    # Readers begin one after the other, and the proxy is behind the arm.
    both = [index for index, value in enumerate(published) if value in received]
    compared = published[both[0] : both[-1] + 1]
    expect(f"{len(compared)} of {len(published)} messages", len(compared) > 30, True)
    # Signals are read without acknowledgement: a busy machine may lose some.
    lost = [value for value in compared if value not in received]
    expect(f"messages that did not pass: {lost}", len(lost) < 0.1 * len(compared), True)
    sent = {math.sin(number / RATE_HZ) for number in range(MESSAGES)}
    expect("messages that were changed", [v for v in received if v not in sent], [])


def shifted(run: Run) -> None:
    """A monitor sees the wrong value during the fault, and the right one before and after it."""
    start, end = fault(run, "slipped")
    expect("duration", 0.9 < end - start < 1.5, True)
    elbow = signals(run, "offset")["elbow"]
    wrong = [at for at, value in elbow if value > OFFSET / 2]
    right = [at for at, value in elbow if value <= OFFSET / 2]
    expect("wrong values", len(wrong) > 30, True)
    limits = start - MARGIN_SECS < wrong[0] < wrong[-1] < end + MARGIN_SECS
    expect("only during the fault", limits, True)
    order = (right[0], start, end, right[-1])
    expect(f"right before and after: {order}", list(order), sorted(order))
    expect("none between", [at for at in right if wrong[0] < at < wrong[-1]], [])
    expect_in("monitor `elbow in range`", run.output.read_text())


def frozen_lossy_and_late(run: Run) -> None:
    """The wrist rises with each message, unless it is frozen."""
    points = signals(run, "injected")
    wrist = points["wrist"]

    def during(name: str) -> Points:
        start, end = fault(run, name)
        return [(at, value) for at, value in wrist if start + MARGIN_SECS < at < end - MARGIN_SECS]

    frozen = during("frozen")
    expect("messages that are frozen", len(frozen) > 20, True)
    expect("frozen", len({value for _, value in frozen}), 1)
    count = (during("lossy")[-1][1] - during("lossy")[0][1]) / (0.1 * PERIOD_SECS)
    share = (len(during("lossy")) - 1) / count
    expect(f"half of the messages are lost: {share}", 0.25 < share < 0.75, True)
    # Times of headers do not show the delay: no message is lost, none overtakes another.
    values = [value for _, value in wrist if value > during("lossy")[-1][1]]
    late = during("late")
    expect("late messages", len(late) > 20, True)
    expect("in order", all(a < b for a, b in itertools.pairwise(values)), True)


@each_source
def test_nothing_is_left_of_a_killed_runner(rtf: str, tmp_path: Path, source: str) -> None:
    run = Run(rtf, suite_of(source), tmp_path / "results", "--filter", "name(stay)")
    run.wait_for(lambda event: event["type"] == "fault-injected")
    kill(children(run.process.pid))
    expect("exit code", run.wait(), 5)
    mark = f"{MARK}={os.environ[MARK]}"
    left = select(lambda _, __, variables: mark in variables)
    expect("processes that are left", commands(left), [])


@pytest.mark.middleware("ros1")
def test_the_time_of_the_robot_jumps(rtf: str, tmp_path: Path) -> None:
    """The test takes as long as without a jump."""
    run = Run(rtf, suite_of("ros-clock"), tmp_path / "results")
    expect("exit code", run.wait(), 0)
    start, end = fault(run, "back")
    expect("the time of the suite continues", 0.9 < end - start < 1.5, True)
    robot = signals(run, "jump")["robot"]
    # Times of samples are those of the suite, so this is the difference of both clocks. On a busy
    # machine, single messages arrive late.
    usual = statistics.median(value - at for at, value in robot if at < start - MARGIN_SECS)
    behind = [(at, value - at - usual) for at, value in robot]
    wrong = [at for at, difference in behind if difference < JUMP_SECS / 2]
    expect("the robot is behind", len(wrong) > 30, True)
    limits = start - MARGIN_SECS < wrong[0] < wrong[-1] < end + MARGIN_SECS
    expect("only during the fault", limits, True)
    right = [difference for at, difference in behind if at > end + MARGIN_SECS]
    expect("right after it", abs(statistics.median(right)) < MARGIN_SECS, True)


def fault(run: Run, name: str) -> tuple[float, float]:
    """When a fault began and ended, since the start of its test."""
    started: dict[int, float] = {}
    begin = 0.0
    for event in run.events():
        at = time_of(event)
        if event["type"] == "test-started":
            started[event["test"]] = at
        elif event["type"] == "fault-injected" and event["name"] == name:
            begin = at - started[event["test"]]
        elif event["type"] == "fault-removed" and event["name"] == name:
            return begin, at - started[event["test"]]
    raise AssertionError(f"the fault {name} has no end")


def time_of(event: Event) -> float:
    """The time of an event in seconds."""
    return float(event["at"]) / 1e6


def signals(run: Run, test: str) -> dict[str, Points]:
    """All samples of each signal of a test."""
    found: dict[str, Points] = {}
    for event in run.events("sampled"):
        if run.name(event) == test:
            batch = event["samples"]
            found.setdefault(batch["name"], []).extend(map(tuple, batch["points"]))
    return found
