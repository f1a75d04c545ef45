#!/usr/bin/env python3
"""Runs example 07 as a user does, and once more while its simulator is killed.

    check_example_07.py RTF FOLDER

All levels, side by side as far as they may: they share one robot, so they take
turns. Then the stress level for a time, and the system level, in the middle of
which the process that steps the physics gets a SIGKILL.
"""

from __future__ import annotations

import os
import signal
import sys
import tempfile
from pathlib import Path

from check_example_01 import Run, expect, is_a

LEVELS = ["integration", "interface", "stress", "system"]
SOAK = 10.0
"""Seconds; longer than the simulator's start and one round."""


def main() -> int:
    """Runs all and tells the first thing that is not as it should be."""
    rtf, example = sys.argv[1], Path(sys.argv[2]).resolve()
    rtf = str(Path(rtf).resolve())
    with tempfile.TemporaryDirectory() as folder:
        all_levels(rtf, example, Path(folder) / "all")
        in_ci(rtf, example, Path(folder) / "ci")
        repeated(rtf, example, Path(folder) / "repeated")
        simulator_killed(rtf, example, Path(folder) / "killed")
    return 0


def all_levels(rtf: str, example: Path, folder: Path) -> None:
    """Everything passes; no two levels have the arm at the same time."""
    run = Run(rtf, str(example), folder, "--jobs", "4")
    expect("exit code", run.wait(), 0)
    expect("verdicts", set(run.verdicts().values()), {"passed"})
    planned = [event["name"] for event in run.events() if is_a(event, "suite-planned")]
    expect("levels", sorted(planned), LEVELS)
    kinds = [event["type"] for event in run.events()]
    turns = [kind for kind in kinds if kind in ("suite-started", "suite-finished")]
    expect("turns", turns, ["suite-started", "suite-finished"] * len(LEVELS))
    repetitions = [e["repetition"] for e in run.events() if is_a(e, "test-started")]
    expect("repetitions", max(repetitions), 5)
    expect("measured", any(is_a(event, "used") for event in run.events()), True)
    expect("growth", "grow" in run.output.read_text(), False)
    expect("arms left", arms(), [])


def in_ci(rtf: str, example: Path, folder: Path) -> None:
    """The profile leaves the stress level out, and writes a report."""
    report = example / "junit.xml"
    run = Run(rtf, str(example), folder, "--profile", "ci")
    expect("exit code", run.wait(), 0)
    planned = {event["name"] for event in run.events() if is_a(event, "suite-planned")}
    expect("levels", planned, set(LEVELS) - {"stress"})
    expect("report", report.exists(), True)
    report.unlink()


def repeated(rtf: str, example: Path, folder: Path) -> None:
    """Rounds of one suite fill the time, on one start of the simulator."""
    suite = str(example / "integration.xml")
    run = Run(rtf, suite, folder, "--for", f"{SOAK:.0f}s", "--until-fail")
    expect("exit code", run.wait(), 0)
    events = list(run.events())
    (rounds,) = [event["repetitions"] for event in events if is_a(event, "test-repeated")]
    expect("rounds, more than one", rounds > 1, True)
    expect("starts", sum(is_a(event, "fixture-ready") for event in events), 1)
    expect("time is over", events[-1]["at"] >= SOAK * 1e6, True)
    expect("arms left", arms(), [])


def simulator_killed(rtf: str, example: Path, folder: Path) -> None:
    """The task begins anew on a new simulator, and the run is green."""
    run = Run(rtf, str(example / "system.xml"), folder)
    try:
        run.wait_for(lambda event: is_a(event, "message"))
        (arm,) = arms()
        os.kill(arm, signal.SIGKILL)
    except BaseException:
        run.stop()
        raise
    expect("exit code", run.wait(), 0)
    attempts = [event["verdict"] for event in run.events() if is_a(event, "test-finished")]
    expect("attempts", attempts, ["collapsed", "passed"])
    reasons = [event["reason"] for event in run.events() if is_a(event, "fixture-collapsed")]
    expect(f"one collapse by SIGKILL in {reasons}", ["SIGKILL" in each for each in reasons], [True])
    expect("arms left", arms(), [])


def arms() -> list[int]:
    """The simulators of this lesson that run: those whose port `rtf` has chosen."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes().split(b"\0")
            scope = b"RTF_PORT_ARM=" in (folder / "environ").read_bytes()
        except OSError:  # it has ended, or is somebody else's
            continue
        if b"../01-simulated-arm/simulator.py" in words and scope:
            found.append(int(folder.name))
    return found


if __name__ == "__main__":
    sys.exit(main())
