#!/usr/bin/env python3
"""Runs example 04 as a user does, with a broken joint, and while the simulator is killed.

    check_example_04.py RTF SUITE

The environment must be set up as the lesson says. The simulator gets a SIGKILL during a test.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

from check_example_01 import simulators
from processes import kill
from run import Event, Run, expect, expect_in

VICTIM = "MovementTest"
STUCK = "l_elbow"


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, suite = (str(Path(argument).resolve()) for argument in sys.argv[1:])
    with tempfile.TemporaryDirectory() as directory:
        os.environ["YARP_CONFIG_HOME"] = str(Path(directory) / "home")
        undisturbed(rtf, suite, Path(directory) / "undisturbed")
        broken(rtf, suite, Path(directory) / "broken")
        killed(rtf, suite, Path(directory) / "killed")
    return 0


def undisturbed(rtf: str, suite: str, directory: Path) -> None:
    """All tests pass, and no process is left."""
    run = Run(rtf, suite, directory)
    expect("exit code", run.wait(), 0)
    expect("verdicts", list(run.verdicts().values()), ["passed"] * 6)
    expect("pictures", pictures(run), {})
    expect("simulators left", simulators(suite), [])


def broken(rtf: str, suite: str, directory: Path) -> None:
    """The tests that move the joint fail, each with a picture."""
    os.environ["ICUB_STUCK"] = STUCK
    run = Run(rtf, suite, directory)
    del os.environ["ICUB_STUCK"]
    expect("exit code", run.wait(), 1)
    failed = [name for name, verdict in run.verdicts().items() if verdict != "passed"]
    expect("failed", failed, [VICTIM, "LeftArmAccuracy"])
    taken = pictures(run)
    expect("tests with a picture", list(taken), failed)
    for picture in taken.values():
        expect("a PNG", (directory / "latest" / picture).read_bytes()[:8], b"\x89PNG\r\n\x1a\n")


def killed(rtf: str, suite: str, directory: Path) -> None:
    """The test is `collapsed`, the reason names the module, and the others pass."""
    run = Run(rtf, suite, directory)
    run.disturb(lambda: kill(simulators(suite)), VICTIM)
    expect("exit code", run.wait(), 1)
    verdicts = run.verdicts()
    expect(f"verdict of {VICTIM}", verdicts.pop(VICTIM), "collapsed")
    expect("other verdicts", list(verdicts.values()), ["passed"] * 5)
    expect_in("simulator.py", run.reasons()[0])
    expect("simulators left", simulators(suite), [])


def pictures(run: Run) -> dict[str, str]:
    """The pictures, by test."""

    def path(event: Event) -> str:
        return str(event["attachment"]["path"])

    return {run.name(event): path(event) for event in run.events("attached")}


if __name__ == "__main__":
    sys.exit(main())
