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
import sys
import tempfile
from pathlib import Path

from processes import kill, running, shared_memory
from run import Run, expect, expect_in

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
        os.environ["PATH"] = f"{Path(suite).parent / 'bin'}:{os.environ['PATH']}"
        undisturbed(rtf, suite, home / "undisturbed")
        collapses(rtf, suite, home / "killed", signal.SIGKILL, "talker-1 died, exit code -9")
        collapses(rtf, suite, home / "silent", signal.SIGSTOP, "no message on /chatter for 2 s")
        launch_killed(rtf, suite, home / "launch-killed")
        dies_early(rtf, suite, home / "early")
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


def undisturbed(rtf: str, suite: str, directory: Path) -> None:
    """All tests pass, also with a process that exits successfully."""
    run = Run(rtf, suite, directory)
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


def dies_early(rtf: str, suite: str, directory: Path) -> None:
    """A node that dies before it is ready fails the set-up at once; its last output is shown."""
    run = Run(rtf, suite, directory, "--set=rate=fast")
    expect("exit code", run.wait(), 1)
    expect_in("talker-1 died, exit code 1", run.reason("fixture-broken"))
    told = "could not convert string to float: 'fast'" in run.output.read_text()
    expect("last output is reported", told, True)


if __name__ == "__main__":
    sys.exit(main())
