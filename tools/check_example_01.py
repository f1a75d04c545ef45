#!/usr/bin/env python3
"""Runs example 01 as a user does, and a second time while its simulator is killed.

    check_example_01.py RTF SUITE

The simulator gets a SIGKILL during a test. Exit code and journal of both runs are checked.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from processes import kill, select
from run import Run, expect, expect_in

VICTIM = "AccuracyTest"


def main() -> int:
    """Runs both; exits at the first difference."""
    rtf, suite = (str(Path(argument).resolve()) for argument in sys.argv[1:])
    with tempfile.TemporaryDirectory() as directory:
        undisturbed(rtf, suite, Path(directory) / "undisturbed")
        simulator_killed(rtf, suite, Path(directory) / "killed")
    return 0


def undisturbed(rtf: str, suite: str, directory: Path) -> None:
    """All tests pass, and no process is left."""
    run = Run(rtf, suite, directory)
    expect("exit code", run.wait(), 0)
    expect("verdicts", set(run.verdicts().values()), {"passed"})
    expect("tests", len(run.verdicts()), 3)
    measured = {event["measurement"]["name"] for event in run.events("measured")}
    expect("measured", {"worst error", "sampling rate"} <= measured, True)
    expect("simulators left", simulators(suite), [])


def simulator_killed(rtf: str, suite: str, directory: Path) -> None:
    """The running test is `collapsed` within a second; the others pass."""
    run = Run(rtf, suite, directory)
    noticed = run.collapses(lambda: kill(simulators(suite)), VICTIM)
    expect("exit code", run.wait(), 1)
    expect("seconds until the collapse was detected, below 1", noticed < 1, True)
    verdicts = run.verdicts()
    expect(f"verdict of {VICTIM}", verdicts.pop(VICTIM), "collapsed")
    expect("other verdicts", sorted(verdicts.values()), ["passed", "passed"])
    expect("starts of the simulator", len(list(run.events("fixture-ready"))), 2)
    expect_in("SIGKILL", run.reason())
    expect("simulators left", simulators(suite), [])


def simulators(suite: str) -> list[int]:
    """The simulators of this suite."""
    home = Path(suite).parent
    return select(
        lambda entry, words, _: "simulator.py" in words and (entry / "cwd").resolve() == home
    )


if __name__ == "__main__":
    sys.exit(main())
