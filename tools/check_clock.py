#!/usr/bin/env python3
"""Runs tests in simulated time with real middleware; the clock runs, pauses, or is killed.

    check_clock.py RTF SUITE

The simulator is a process of ROS 1, ROS 2 or YARP that sends only the time.
"""

from __future__ import annotations

import os
import signal
import sys
import tempfile
from pathlib import Path

from run import Run, expect, is_a

SLOW = ("--set=speed=0.2", "--set=seconds=0.2")


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, suite = (Path(argument).resolve() for argument in sys.argv[1:])
    with tempfile.TemporaryDirectory() as name:
        # Identifies the processes of the runs.
        os.environ["YARP_CONFIG_HOME"] = os.environ["ROS_HOME"] = f"{name}/home"
        for variable in ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_IP", "YARP_NAMESPACE"):
            os.environ.pop(variable, None)
        scene = Scene(rtf, suite, Path(name))
        scene.goes()
        scene.halted()
        scene.killed()
    return 0


class Scene:
    """Runs of one suite."""

    def __init__(self, rtf: Path, suite: Path, directory: Path) -> None:
        self.rtf, self.suite, self.directory = rtf, suite, directory

    def goes(self) -> None:
        """A simulated limit of eight seconds takes less than eight seconds of wall time."""
        run = self.start("goes")
        self.finish(run, {"Pause": "timed-out", self.follower(): "passed"})
        self.expect_reason(run, "run did not end within 8s of simulated time, which took ")

    def halted(self) -> None:
        """A test does not wait indefinitely for a paused clock."""
        run = self.start("halted", *SLOW)
        self.disturb(run, signal.SIGSTOP)
        run.wait_for(lambda event: is_a(event, "test-stopping"))
        for pid in self.simulators():
            os.kill(pid, signal.SIGCONT)
        self.finish(run, {"Pause": "timed-out", self.follower(): "passed"})
        reason = "run did not end within 8s of simulated time, nor within 8s: the clock "
        self.expect_reason(run, reason)

    def killed(self) -> None:
        """A lost clock is a collapse; after a restart, tests follow it again."""
        run = self.start("killed", *SLOW)
        self.disturb(run, signal.SIGKILL)
        if self.suite.stem == "ros2":
            # For 20 s, ROS treats a killed node like a silent one.
            self.finish(run, {"Pause": "timed-out", self.follower(): "passed"})
            return
        self.finish(run, {"Pause": "collapsed", self.follower(): "passed"})
        (reason,) = [event["reason"] for event in run.events() if is_a(event, "fixture-collapsed")]
        expect(f"lost in {reason!r}", reason.startswith("the simulated time is lost: "), True)

    def start(self, name: str, *options: str) -> Run:
        """Starts a run."""
        print(f"--- {name}", flush=True)
        return Run(str(self.rtf), str(self.suite), self.directory / f"{name}.run", *options)

    def disturb(self, run: Run, number: signal.Signals) -> None:
        """Sends a signal to the simulator while the first test waits."""
        try:
            run.wait_for(lambda event: is_a(event, "test-phase") and event["phase"] == "run")
            (simulator,) = self.simulators()
            os.kill(simulator, number)
        except BaseException:
            run.stop()
            raise

    def finish(self, run: Run, verdicts: dict[str, str]) -> None:
        """Waits until the run ends; no process is left."""
        expect("exit code", run.wait(), 1)
        expect("verdicts", run.verdicts(), verdicts)
        expect("processes left", self.processes(""), [])

    def expect_reason(self, run: Run, expected: str) -> None:
        """The waiting test ended with this reason."""
        reasons = [event.get("reason") for event in run.events() if is_a(event, "test-stopping")]
        expect("stopped tests", len(reasons), 1)
        expect(f"`{expected}` in {reasons[0]!r}", str(reasons[0]).startswith(expected), True)

    def follower(self) -> str:
        """The test that compares the times."""
        return {"ros": "RosTime", "ros2": "Ros2Time", "yarp": "YarpTime"}[self.suite.stem]

    def simulators(self) -> list[int]:
        """The simulator, without the process that runs it."""
        return self.processes("_simulator.py", unless="keeper.py")

    def processes(self, word: str, unless: str = "\0") -> list[int]:
        """The processes of the runs whose command line contains a word, without zombies."""
        mark = f"ROS_HOME={os.environ['ROS_HOME']}".encode()
        found = []
        for entry in Path("/proc").glob("[0-9]*"):
            try:
                is_ours = mark in (entry / "environ").read_bytes().split(b"\0")
                line = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode()
            except OSError:  # it has exited, or belongs to another user
                continue
            if is_ours and word in line and unless not in line and int(entry.name) != os.getpid():
                found.append(int(entry.name))
        return found


if __name__ == "__main__":
    sys.exit(main())
