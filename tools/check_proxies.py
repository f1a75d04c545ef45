#!/usr/bin/env python3
"""Injects wrong values into the topics and ports of real middleware.

    check_proxies.py RTF DIRECTORY SOURCE

SOURCE is `ros`, `ros2` or `yarp`, whose suite has this name in DIRECTORY.
"""

from __future__ import annotations

import itertools
import math
import os
import signal
import sys
import tempfile
from pathlib import Path

from run import Event, Run, expect, expect_in

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


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, directory, source = str(Path(sys.argv[1]).resolve()), Path(sys.argv[2]), sys.argv[3]
    suite = str((directory / f"{source}.xml").resolve())
    with tempfile.TemporaryDirectory() as name:
        os.environ["ROS_HOME"] = os.environ["YARP_CONFIG_HOME"] = f"{name}/home"
        for variable in ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_IP", "YARP_NAMESPACE"):
            os.environ.pop(variable, None)
        run = Run(rtf, suite, Path(name) / "values", "--filter", "not name(stay)")
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
        killed(rtf, suite, Path(name) / "killed", name)
        if source == "ros":
            jumped(rtf, str((directory / "ros-clock.xml").resolve()), Path(name) / "clock")
    return 0


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


def killed(rtf: str, suite: str, results: Path, mark: str) -> None:
    """After the death of the runner, nothing is left."""
    run = Run(rtf, suite, results, "--filter", "name(stay)")
    run.wait_for(lambda event: event["type"] == "fault-injected")
    (runner,) = [pid for pid in children(run.process.pid) if b"rtf" in command(pid)][:1]
    os.kill(runner, signal.SIGKILL)
    expect("exit code", run.wait(), 5)
    expect("processes that are left", left(mark), [])


def jumped(rtf: str, suite: str, results: Path) -> None:
    """The time of the robot jumps, and the test takes as long as without a jump."""
    run = Run(rtf, suite, results)
    expect("exit code", run.wait(), 0)
    start, end = fault(run, "back")
    expect("the time of the suite continues", 0.9 < end - start < 1.5, True)
    robot = signals(run, "jump")["robot"]
    # Times of samples are those of the suite, so this is the difference of both clocks.
    behind = [(at, value - at - (robot[0][1] - robot[0][0])) for at, value in robot]
    wrong = [at for at, difference in behind if difference < JUMP_SECS / 2]
    expect("the robot is behind", len(wrong) > 30, True)
    limits = start - MARGIN_SECS < wrong[0] < wrong[-1] < end + MARGIN_SECS
    expect("only during the fault", limits, True)
    right = [difference for at, difference in behind if at > end + MARGIN_SECS]
    expect("right after it", max(map(abs, right)) < MARGIN_SECS, True)


def children(parent: int) -> list[int]:
    """The child processes of a process."""
    text = Path(f"/proc/{parent}/task/{parent}/children").read_text()
    return [int(word) for word in text.split()]


def command(pid: int) -> bytes:
    """The command line of a process."""
    return Path(f"/proc/{pid}/cmdline").read_bytes()


def left(mark: str) -> list[str]:
    """The processes of the run, which have a directory in their environment."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            environment = (process / "environ").read_bytes()
            if int(process.name) != os.getpid() and mark.encode() in environment:
                found.append((process / "cmdline").read_bytes().replace(b"\0", b" ").decode())
        except OSError:
            continue
    return found


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
    raise SystemExit(f"the fault {name} has no end")


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


if __name__ == "__main__":
    sys.exit(main())
