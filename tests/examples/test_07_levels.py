"""Runs example 07 as a user does, and a second time while its simulator is killed.

The levels share one robot, so they run one after the other.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from checkout import ROOT
from processes import kill, running
from run import Run, expect, expect_in, is_a

pytestmark = pytest.mark.venv("demo")
EXAMPLE = ROOT / "examples/07-levels"
LEVELS = ["integration", "interface", "stress", "system"]
SOAK = 10.0
"""Seconds; longer than the simulator's start and one round."""


@pytest.fixture(autouse=True)
def _private_locks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Another test may use its own arm.
    monkeypatch.setenv("RTF_LOCKS", str(tmp_path / "locks"))


def test_levels_share_one_arm(rtf: str, tmp_path: Path) -> None:
    """All tests pass; no two levels use the arm at the same time."""
    run = Run(rtf, str(EXAMPLE), tmp_path / "results", "--jobs", "4")
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


def test_the_profile_of_ci_excludes_a_level(rtf: str, tmp_path: Path) -> None:
    """The profile excludes the stress level and writes a report."""
    for lesson in ("01-simulated-arm", EXAMPLE.name):
        shutil.copytree(EXAMPLE.parent / lesson, tmp_path / lesson)
    copy = tmp_path / EXAMPLE.name
    run = Run(rtf, str(copy), tmp_path / "results", "--profile", "ci")
    expect("exit code", run.wait(), 0)
    planned = {event["name"] for event in run.events("suite-planned")}
    expect("levels", planned, set(LEVELS) - {"stress"})
    expect("report", (copy / "junit.xml").exists(), True)


def test_rounds_fill_the_time_with_one_start(rtf: str, tmp_path: Path) -> None:
    suite = str(EXAMPLE / "integration.xml")
    run = Run(rtf, suite, tmp_path / "results", "--for", f"{SOAK:.0f}s", "--until-fail")
    expect("exit code", run.wait(), 0)
    events = list(run.events())
    (rounds,) = [event["repetitions"] for event in events if is_a(event, "test-repeated")]
    expect("rounds, at least two", rounds > 1, True)
    expect("starts", sum(is_a(event, "fixture-ready") for event in events), 1)
    expect("time is up", events[-1]["at"] >= SOAK * 1e6, True)
    expect("arms left", arms(), [])


def test_a_collapsed_task_is_rerun_on_a_new_simulator(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, str(EXAMPLE / "system.xml"), tmp_path / "results")
    run.disturb(lambda: kill(arms()), once="message")
    expect("exit code", run.wait(), 0)
    expect("attempts", run.attempts(), ["collapsed", "passed"])
    expect_in("SIGKILL", run.reason())
    expect("arms left", arms(), [])


def arms() -> list[int]:
    """The running simulators."""
    return running("simulator.py")
