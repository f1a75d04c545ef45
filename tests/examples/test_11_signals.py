"""Runs example 11 as a user does: a monitor finds an overshoot in a test that would pass, its
recording is replayed, more damping avoids it, and a violated limit stops a test. A camera is cut
off for half a second.
"""

from __future__ import annotations

import shlex
import shutil
from pathlib import Path

import pytest
from checkout import ROOT
from run import Event, Run, expect, expect_in

pytestmark = pytest.mark.venv("mcap")
EXAMPLE = ROOT / "examples/11-signals"
ARM, CAMERA = str(EXAMPLE / "arm.xml"), str(EXAMPLE / "camera.xml")
SHELF = 1.05
"""In radians."""


def test_a_monitor_finds_an_overshoot_and_the_replay_repeats_it(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, ARM, tmp_path / "overshoot")
    overshoot(run)
    replayed(run, rtf, tmp_path)


def overshoot(run: Run) -> None:
    """The test itself reports no failure; the samples show how long the arm was at the shelf."""
    expect("exit code", run.wait(), 1)
    expect("verdicts", run.verdicts(), {"near": "passed", "far": "failed"})
    [failure] = failures(run)
    expect("test", run.name({"test": failure["source"]["test"]}), "far")
    expect_in("monitor `does not touch the shelf`: `1.05rad > q` does not hold", str(failure))
    points = samples(run, "far", "q")
    above = [time for time, value in points if value > SHELF]
    expect("80 ms at the shelf", 0.05 < above[-1] - above[0] < 0.15, True)
    expect("samples of each test", len(samples(run, "near", "q")) > 300, True)
    expect("signals", signals(run), {"q", "dq", "goal", "memory"})
    robustness = measured(run, "monitor/does not touch the shelf")
    expect("near the shelf", robustness["near"] > 0.4, True)
    expect("in the shelf", -0.1 < robustness["far"] < 0, True)


def replayed(run: Run, rtf: str, results: Path) -> None:
    """The command in the summary repeats the failure without the arm; a farther shelf does not."""
    lines = run.output.read_text().splitlines()
    [line] = [line for line in lines if line.startswith("    replay ")]
    words = shlex.split(line)[1:]
    expect("command", words[:2], ["rtf", "run"])
    repeated = Run(rtf, words[2], results / "repeated", *words[3:])
    expect("exit code", repeated.wait(), 1)
    expect("verdicts", repeated.verdicts(), {"far": "failed"})
    [failure] = failures(repeated)
    expect_in("monitor `does not touch the shelf`: `1.05rad > q` does not hold", str(failure))
    interval = failure["message"]["interval"]
    expect("interval", interval["signals"], ["q"])
    expect("its start", 0 < interval["start"] <= interval["end"] < 1.5, True)
    name = "monitor/does not touch the shelf"
    robustness = [measured(each, name)["far"] for each in (run, repeated)]
    expect("the same robustness", abs(robustness[0] - robustness[1]) < 1e-6, True)
    farther = Run(rtf, words[2], results / "farther", *words[3:], "--set", "shelf=1.1")
    expect("exit code", farther.wait(), 0)


def test_more_damping_avoids_the_overshoot(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, ARM, tmp_path / "results", "--set", "damping=1")
    expect("exit code", run.wait(), 0)
    expect("all monitors hold", all(value > 0 for value in all_measured(run)), True)


@pytest.mark.parametrize(
    ("limit", "options"),
    [
        pytest.param("5rad/s", [], id="robot"),
        pytest.param("4.5rad/s", ["--profile", "simulation"], id="simulation"),
    ],
)
def test_a_limit_of_the_envelope_stops_the_motion(
    rtf: str, tmp_path: Path, limit: str, options: list[str]
) -> None:
    copy = tmp_path / "copy"
    shutil.copytree(EXAMPLE, copy)
    model = (copy / "arm.urdf").read_text()
    expect_in('velocity="12"', model)
    (copy / "arm.urdf").write_text(model.replace('velocity="12"', 'velocity="5"'))
    run = Run(rtf, str(copy / "arm.xml"), tmp_path / "results", *options)
    expect("exit code", run.wait(), 1)
    expect("verdicts", run.verdicts(), {"near": "passed", "far": "failed"})
    [stopping] = run.events("test-stopping")
    expect("cause", stopping["cause"], "finding")
    expect_in(f"monitor `arm: elbow velocity`: `abs(dq) <= {limit}`", stopping["reason"])
    expect_in("arm.limits.yaml:7:5)", stopping["reason"])


def test_the_robot_stops_while_the_camera_is_cut_off(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, CAMERA, tmp_path / "results")
    expect("exit code", run.wait(), 0)
    [injected] = run.events("fault-injected")
    [removed] = run.events("fault-removed")
    expect("test", run.name(injected), "is blind for a moment")
    expect("fault", (injected["name"], injected["kind"]), ("cut off", "stop"))
    # The times at which the runner has heard of both, in microseconds.
    expect("half a second", 0.49e6 <= removed["at"] - injected["at"] < 1e6, True)
    expect("stops", 0.0 in {speed for _, speed in samples(run, run.name(injected), "speed")}, True)


def test_a_robot_with_more_patience_drives_blindly(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, CAMERA, tmp_path / "results", "--set", "patience=10")
    expect("exit code", run.wait(), 1)
    expect("verdicts", run.verdicts(), {"sees": "passed", "is blind for a moment": "failed"})
    [failure] = failures(run)
    expect_in("monitor `does not drive blindly`", str(failure))


def failures(run: Run) -> list[Event]:
    """All failures of tests."""
    return [event for event in run.events("message") if event["message"]["kind"] == "failure"]


def samples(run: Run, test: str, signal: str) -> list[tuple[float, float]]:
    """All samples of a signal in a test."""
    found = [event for event in run.events("sampled") if run.name(event) == test]
    batches = [event["samples"] for event in found if event["samples"]["name"] == signal]
    return [(time, value) for batch in batches for time, value in batch["points"]]


def signals(run: Run) -> set[str]:
    """The names of all signals."""
    return {event["samples"]["name"] for event in run.events("sampled")}


def measured(run: Run, name: str) -> dict[str, float]:
    """A measurement of each test."""
    found: list[Event] = [
        event for event in run.events("measured") if event["measurement"]["name"] == name
    ]
    return {run.name(event): event["measurement"]["value"] for event in found}


def all_measured(run: Run) -> list[float]:
    """The values of all measurements of monitors."""
    values = [event["measurement"] for event in run.events("measured")]
    return [each["value"] for each in values if each["name"].startswith("monitor/")]
