#!/usr/bin/env python3
"""Runs the fixture `ros2launch` while its nodes are killed, stopped and missing.

    check_fixture_ros2launch.py RTF SUITE

The nodes are real. There are no packages of the `ros2` command, so a substitute starts
them and reproduces the recorded behaviour of the real command.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path

import rclpy
from processes import kill, running, shared_memory
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from run import Run, expect, expect_in
from std_msgs.msg import Float64

SECONDS = "--set=seconds=15"
"""How long the first test listens, in seconds: long enough to disturb it."""


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, suite = (str(Path(argument).resolve()) for argument in sys.argv[1:])
    before = shared_memory()
    with tempfile.TemporaryDirectory() as directory:
        home = Path(directory)
        for name in ("ROS_DOMAIN_ID", "ROS_LOG_DIR"):
            os.environ.pop(name, None)
        without_ros2(rtf, suite, home / "without")
        hidden_nodes(Path(suite).parents[3] / "fixtures")
        os.environ["PATH"] = f"{Path(suite).parent / 'bin'}:{os.environ['PATH']}"
        undisturbed(rtf, suite, home / "undisturbed")
        killed = "talker-1 was killed by SIGKILL"
        collapses(rtf, suite, home / "killed", signal.SIGKILL, killed)
        collapses(rtf, suite, home / "silent", signal.SIGSTOP, "no message on /chatter for 2 s")
        required(rtf, suite, home / "required")
        launch_killed(rtf, suite, home / "launch-killed")
        broken(rtf, suite, home)
        crashes_at_the_end(rtf, suite, home)
        expect("nodes left", running("talker.py"), [])
        expect("shared memory left", shared_memory() - before, set())
    return 0


def without_ros2(rtf: str, suite: str, directory: Path) -> None:
    """Without ROS 2, the reason says so and how to install it."""
    if found := shutil.which("ros2"):
        raise SystemExit(f"{found} is on PATH: this check needs a PATH without it")
    run = Run(rtf, suite, directory)
    expect("exit code without ros2", run.wait(), 1)
    told = run.reason("fixture-broken")
    expect_in("set-up failed: there is no program `ros2` on PATH", told)
    expect_in("https://docs.ros.org", told)


def hidden_nodes(fixtures: Path) -> None:
    """A program of signals hears what was published before, and leaves the graph at its end.

    It also hears a publisher that comes later and offers less.
    """
    settings = {"ROS_DOMAIN_ID": "97", "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    os.environ.update(settings)
    rclpy.init()
    try:
        observer = rclpy.create_node("observer")
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        publisher = observer.create_publisher(Float64, "/level", latched)
        publisher.publish(Float64(data=0.5))
        values: list[str] = []
        with subprocess.Popen(
            [sys.executable, fixtures / "rtf_fixtures/ros2_signals.py", "/level.data"],
            stdout=subprocess.PIPE,
            text=True,
        ) as signals:
            output = signals.stdout or ()
            reading = threading.Thread(
                target=lambda: values.extend(line.split()[1] for line in output)
            )
            reading.start()
            wait_until("the earlier message", lambda: values == ["0.5"], signals)
            expect("a node of signals", len(hidden(observer)), 1)
            less = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
            late = observer.create_publisher(Float64, "/level", less)

            def is_heard() -> bool:
                late.publish(Float64(data=0.75))
                return "0.75" in values

            wait_until("a publisher that offers less", is_heard, signals)
            signals.terminate()
        wait_until("it has left", lambda: hidden(observer) == [])
        observer.destroy_node()
    finally:
        rclpy.try_shutdown()
        for name in settings:
            del os.environ[name]


def hidden(observer: rclpy.node.Node) -> list[str]:
    """The nodes of rtf that a node sees."""
    return [name for name in observer.get_node_names() if name.startswith("_rtf_")]


def wait_until(
    what: str, condition: Callable[[], bool], program: subprocess.Popen[str] | None = None
) -> None:
    """Wait for a condition, and kill the program if it does not hold in time."""
    # Others see a node that did not leave for 20 s after the end of its program.
    limit = 15 if program is None else 120
    deadline = time.monotonic() + limit
    while not condition():
        if time.monotonic() > deadline:
            if program is not None:
                program.kill()
            raise SystemExit(f"not within {limit} s: {what}")
        time.sleep(0.05)
    print(f"ok: {what}", flush=True)


def undisturbed(rtf: str, suite: str, directory: Path) -> None:
    """All tests pass, also with a process that exits successfully.

    The process has the name of its node, one topic was published once, before anyone listened and
    long before the end, and the user prefers other messages of launch.
    """
    options = "--process speaker --topic /description --topic /chatter --silence 2"
    os.environ["OVERRIDE_LAUNCH_SCREEN_FORMAT"] = "{name} ({levelname}) \\x1b[31m{msg}\\x1b[0m"
    file = "--set=file=named.launch.xml"
    run = Run(rtf, suite, directory, file, f"--set=options={options}", "--set=seconds=4")
    del os.environ["OVERRIDE_LAUNCH_SCREEN_FORMAT"]
    expect("exit code", run.wait(), 0)
    expect("verdicts", set(run.verdicts().values()), {"passed"})
    expect("nodes left", running("talker.py"), [])


def collapses(rtf: str, suite: str, directory: Path, number: signal.Signals, why: str) -> None:
    """After a signal to the talker, the test is `collapsed`; the next has a new talker."""
    run = Run(rtf, suite, directory, SECONDS)
    run.collapses(lambda: kill(running("talker.py"), number))
    expect(f"exit code after {number.name}", run.wait(), 1)
    expect("verdicts", list(run.verdicts().values()), ["collapsed", "passed"])
    expect("reason", run.reason(), why)
    expect("starts", len(list(run.events("fixture-ready"))), 2)
    expect("nodes left", running("talker.py"), [])


def launch_killed(rtf: str, suite: str, directory: Path) -> None:
    """A SIGKILL to launch itself leaves its nodes behind: rtf kills them."""
    run = Run(rtf, suite, directory, SECONDS)
    run.collapses(lambda: kill(running("ros2")))
    expect("exit code", run.wait(), 1)
    expect("reason", run.reason(), "ros2 was killed by SIGKILL")
    expect("verdicts", list(run.verdicts().values()), ["collapsed", "passed"])
    expect("nodes left", running("talker.py"), [])


def required(rtf: str, suite: str, directory: Path) -> None:
    """The end of a required process shuts launch down, and is a collapse at once."""
    run = Run(rtf, suite, directory, SECONDS, "--set=file=required.launch.xml")
    run.collapses(lambda: kill(running("ends.py"), signal.SIGTERM))
    expect("exit code", run.wait(), 1)
    ended = "planner-2 ended with exit code 0, and launch shuts down because it was required"
    expect("reason", run.reason(), ended)
    expect("verdicts", list(run.verdicts().values()), ["collapsed", "passed"])


def broken(rtf: str, suite: str, home: Path) -> None:
    """What cannot be started fails the set-up with the line that says why, which is shown once."""
    cause = "ValueError: could not convert string to float: 'fast'"
    cases: dict[str, tuple[str, ...]] = {
        "early": ("rate=fast", f"talker-1 ended with exit code 1: {cause}"),
        "missing": (
            "file=missing.launch.xml",
            "driver-2 was not started: FileNotFoundError: [Errno 2] No such file or directory: "
            "'./no-such-driver'",
        ),
        "component": (
            "file=component.launch.xml",
            "Failed to load node 'driver' of type 'arm::Driver' in container '/box': Failed to "
            "find class with the requested plugin name.",
        ),
        "once": (
            "file=once.launch.xml",
            "a message on /chatter for a new subscriber: not within 8 s (started: talker-1)",
            "--set=options=--topic /chatter --timeout 8",
        ),
        "unnamed": (
            "options=--process speaker --timeout 2",
            "the start of speaker: not within 2 s (started: talker-1, calibration-2)",
        ),
    }
    for name, (setting, reason, *more) in cases.items():
        run = Run(rtf, suite, home / name, f"--set={setting}", *more)
        expect("exit code", run.wait(), 1)
        expect("reason", run.reason("fixture-broken"), f"set-up failed: {reason}")
        first = "[INFO] [launch]: Default logging verbosity"
        # A talker that is interrupted while it starts prints so much that the first line is cut.
        shown = run.output.read_text()
        expect("the output is shown once", shown.count("last lines:"), 1)
        expect("no line is shown twice", shown.count(first) <= 1, True)


def crashes_at_the_end(rtf: str, suite: str, home: Path) -> None:
    """A process that crashes while launch shuts down is a problem of the tear-down."""
    file = "--set=file=crash.launch.xml"
    run = Run(rtf, suite, home / "crashes", file)
    expect("exit code", run.wait(), 1)
    expect("verdicts", set(run.verdicts().values()), {"passed"})
    (stopped,) = run.events("fixture-stopped")
    shut = "while launch shut down, "
    expect_in(f"{shut}driver-2 was killed by SIGSEGV: it ends with SIGSEGV", stopped["problem"])
    expect_in(f"{shut}logger-3 ended with exit code 7: it ends with 7", stopped["problem"])
    options = "--set=options=--process talker --may-die gripper --may-die logger"
    run = Run(rtf, suite, home / "may-crash", file, options)
    expect("exit code", run.wait(), 0)


if __name__ == "__main__":
    sys.exit(main())
