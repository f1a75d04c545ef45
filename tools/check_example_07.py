#!/usr/bin/env python3
"""Runs example 07 as a user does, and a second time while its simulator is killed.

    check_example_07.py RTF DIRECTORY

First all levels with `--jobs`; they share one robot, so they run one after the other. Then
the stress level for a limited time, and the system level, during which the simulator gets a
SIGKILL.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from processes import kill, select
from run import Run, expect, expect_in, is_a

LEVELS = ["integration", "interface", "stress", "system"]
SOAK = 10.0
"""Seconds; longer than the simulator's start and one round."""


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, example = sys.argv[1], Path(sys.argv[2]).resolve()
    rtf = str(Path(rtf).resolve())
    with tempfile.TemporaryDirectory() as directory:
        all_levels(rtf, example, Path(directory) / "all")
        in_ci(rtf, example, Path(directory) / "ci")
        repeated(rtf, example, Path(directory) / "repeated")
        simulator_killed(rtf, example, Path(directory) / "killed")
    return 0


def all_levels(rtf: str, example: Path, directory: Path) -> None:
    """All tests pass; no two levels use the arm at the same time."""
    run = Run(rtf, str(example), directory, "--jobs", "4")
    expect("exit code", run.wait(), 0)
    expect("verdicts", set(run.verdicts().values()), {"passed"})
    planned = [event["name"] for event in run.events("suite-planned")]
    expect("levels", sorted(planned), LEVELS)
    kinds = [event["type"] for event in run.events()]
    turns = [kind for kind in kinds if kind in ("suite-started", "suite-finished")]
    expect("turns", turns, ["suite-started", "suite-finished"] * len(LEVELS))
    repetitions = [event["repetition"] for event in run.events("test-started")]
    expect("repetitions", max(repetitions), 5)
    expect("measured", any(run.events("resources-measured")), True)
    expect("growth", "grow" in run.output.read_text(), False)
    expect("arms left", arms(), [])


def in_ci(rtf: str, example: Path, directory: Path) -> None:
    """The profile excludes the stress level and writes a report."""
    report = example / "junit.xml"
    run = Run(rtf, str(example), directory, "--profile", "ci")
    expect("exit code", run.wait(), 0)
    planned = {event["name"] for event in run.events("suite-planned")}
    expect("levels", planned, set(LEVELS) - {"stress"})
    expect("report", report.exists(), True)
    report.unlink()


def repeated(rtf: str, example: Path, directory: Path) -> None:
    """Rounds of one suite fill the time with one start of the simulator."""
    suite = str(example / "integration.xml")
    run = Run(rtf, suite, directory, "--for", f"{SOAK:.0f}s", "--until-fail")
    expect("exit code", run.wait(), 0)
    events = list(run.events())
    (rounds,) = [event["repetitions"] for event in events if is_a(event, "test-repeated")]
    expect("rounds, at least two", rounds > 1, True)
    expect("starts", sum(is_a(event, "fixture-ready") for event in events), 1)
    expect("time is up", events[-1]["at"] >= SOAK * 1e6, True)
    expect("arms left", arms(), [])


def simulator_killed(rtf: str, example: Path, directory: Path) -> None:
    """The task is rerun on a new simulator, and the run is green."""
    run = Run(rtf, str(example / "system.xml"), directory)
    run.disturb(lambda: kill(arms()), once="message")
    expect("exit code", run.wait(), 0)
    expect("attempts", run.attempts(), ["collapsed", "passed"])
    expect_in("SIGKILL", run.reason())
    expect("arms left", arms(), [])


def arms() -> list[int]:
    """The running simulators of this lesson, whose port `rtf` chose."""
    return select(
        lambda _, words, variables: (
            "../01-simulated-arm/simulator.py" in words
            and any(each.startswith("RTF_PORT_ARM=") for each in variables)
        )
    )


if __name__ == "__main__":
    sys.exit(main())
