"""Runs example 01 as a user does, and a second time while its simulator is killed."""

from __future__ import annotations

from pathlib import Path

import pytest
from checkout import ROOT
from cpp_plugins import plugins
from processes import kill, running
from run import Run, expect, expect_in

# The suite's port is fixed, so that each run has a separate network.
pytestmark = [pytest.mark.venv("demo"), pytest.mark.outside_network]
SUITE = str(ROOT / "examples/01-simulated-arm/arm.xml")
VICTIM = "AccuracyTest"


@pytest.fixture(autouse=True)
def _plugins(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RTF_PLUGIN_PATH", str(plugins("01-simulated-arm")))


def test_all_pass_and_no_process_is_left(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, SUITE, tmp_path / "results")
    expect("exit code", run.wait(), 0)
    expect("verdicts", set(run.verdicts().values()), {"passed"})
    expect("tests", len(run.verdicts()), 3)
    measured = {event["measurement"]["name"] for event in run.events("measured")}
    expect("measured", {"worst error", "sampling rate"} <= measured, True)
    expect("simulators left", running("simulator.py"), [])


def test_a_killed_simulator_is_detected_within_a_second(rtf: str, tmp_path: Path) -> None:
    """The running test is `collapsed`; the others pass."""
    run = Run(rtf, SUITE, tmp_path / "results")
    noticed = run.collapses(lambda: kill(running("simulator.py")), VICTIM)
    expect("exit code", run.wait(), 1)
    expect("seconds until the collapse was detected, below 1", noticed < 1, True)
    verdicts = run.verdicts()
    expect(f"verdict of {VICTIM}", verdicts.pop(VICTIM), "collapsed")
    expect("other verdicts", sorted(verdicts.values()), ["passed", "passed"])
    expect("starts of the simulator", len(list(run.events("fixture-ready"))), 2)
    expect_in("SIGKILL", run.reason())
    expect("simulators left", running("simulator.py"), [])
