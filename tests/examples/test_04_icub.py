"""Runs example 04 as a user does, with a broken joint, and while the simulator is killed."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path

import pytest
from checkout import BUILD, ROOT, exports
from processes import kill, running
from run import Event, Run, expect, expect_in

pytestmark = pytest.mark.middleware("yarp")
SUITE = str(ROOT / "examples/04-icub/icub.xml")
SIMULATOR = "simulator.py"
VICTIM = "MovementTest"
STUCK = "l_elbow"


@pytest.fixture(autouse=True)
def _environment_of_the_lesson(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What tools/icub.sh sets and builds."""
    BUILD.mkdir(exist_ok=True)
    with (BUILD / "04-icub.lock").open("a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        settings = exports("tools/icub.sh", "bash", "-c", "export -p")
    for name, value in settings.items():
        monkeypatch.setenv(name, value + (os.environ["PATH"] if name == "PATH" else ""))
    monkeypatch.setenv("YARP_CONFIG_HOME", str(tmp_path / "home"))


def test_all_pass_and_no_process_is_left(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, SUITE, tmp_path / "results")
    expect("exit code", run.wait(), 0)
    expect("verdicts", list(run.verdicts().values()), ["passed"] * 6)
    expect("pictures", pictures(run), {})
    expect("simulators left", running(SIMULATOR), [])


def test_a_stuck_joint_fails_its_tests_with_pictures(
    rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ICUB_STUCK", STUCK)
    run = Run(rtf, SUITE, tmp_path / "results")
    expect("exit code", run.wait(), 1)
    failed = [name for name, verdict in run.verdicts().items() if verdict != "passed"]
    expect("failed", failed, [VICTIM, "LeftArmAccuracy"])
    taken = pictures(run)
    expect("tests with a picture", list(taken), failed)
    for picture in taken.values():
        file = run.journal.parent / picture
        expect("a PNG", file.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")


def test_a_collapse_names_the_killed_simulator(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, SUITE, tmp_path / "results")
    run.disturb(lambda: kill(running(SIMULATOR)), VICTIM)
    expect("exit code", run.wait(), 1)
    verdicts = run.verdicts()
    expect(f"verdict of {VICTIM}", verdicts.pop(VICTIM), "collapsed")
    expect("other verdicts", list(verdicts.values()), ["passed"] * 5)
    expect_in("simulator.py", run.reasons()[0])
    expect("simulators left", running(SIMULATOR), [])


def pictures(run: Run) -> dict[str, str]:
    """The pictures, by test."""

    def path(event: Event) -> str:
        return str(event["attachment"]["path"])

    return {run.name(event): path(event) for event in run.events("attached")}
