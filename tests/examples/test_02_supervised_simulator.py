"""Runs example 02 as a user does, a second time while the runner is killed, and with a monitor."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from checkout import ROOT
from processes import children, kill, running
from run import Event, Run, expect, expect_in, is_a

# The simulator has a fixed port.
pytestmark = [pytest.mark.venv("demo"), pytest.mark.outside_network]
SUITE = ROOT / "examples/02-supervised-simulator/supervised.xml"
RUNNER_DIED = 5
SWEEP_SECS = 6
"""How long the first test moves the arm, unless it is stopped."""

LIMIT_RAD = 0.5
"""The monitor's limit: the sweep goes farther, and is there after 0.4 s."""

READER = """
import time
import lesson_1
from arm_client import Arm

arm = Arm()
while True:
    print(f"{time.time():.6f} {arm.position('shoulder')}", flush=True)
    time.sleep(0.002)
"""
WATCHED = f"""
  <signal name="shoulder" unit="rad"><command>python3 read_shoulder.py</command></signal>
  <monitor name="stays low" severity="stop">always({LIMIT_RAD}rad > shoulder)</monitor>
</suite>"""


def test_a_collapse_a_rerun_and_a_parked_arm(rtf: str, tmp_path: Path) -> None:
    """The arm dies once, the test is rerun, and the arm is parked at the end."""
    run = Run(rtf, str(SUITE), tmp_path / "results")
    expect("exit code", run.wait(), 0)
    expect("attempts", run.attempts(), ["collapsed", "passed", "passed"])
    expect("hooks", triggers(run), ["collapse", "end"])
    expect("parked", "parked: " in hook_output(run), True)
    expect("arms left", arms(), [])


def test_the_guard_parks_the_arm_of_a_killed_runner(rtf: str, tmp_path: Path) -> None:
    """The guard parks the arm, and no process is left."""
    run = Run(rtf, str(SUITE), tmp_path / "results")
    try:
        run.wait_for(is_rerun)
        run.wait_for(lambda event: is_a(event, "test-phase") and runs_again(run))
        kill(children(run.process.pid))
    except BaseException:
        run.stop()
        raise
    expect("exit code", run.wait(), RUNNER_DIED)
    last = list(run.events())[-1]
    expect("last event", last["type"], "runner-died")
    expect("hooks", triggers(run), ["collapse", "interrupt"])
    expect("parked", "parked: " in hook_output(run), True)
    expect("arms left", arms(), [])


def test_a_monitor_stops_the_motion(rtf: str, tmp_path: Path) -> None:
    """A monitor with `stop` interrupts the motion, and the hook parks the arm at once."""
    lessons = SUITE.parent.parent
    for lesson in ("01-simulated-arm", SUITE.parent.name):
        shutil.copytree(lessons / lesson, tmp_path / "lessons" / lesson)
    copy = tmp_path / "lessons" / SUITE.parent.name
    (copy / "read_shoulder.py").write_text(READER)
    change(copy / SUITE.name, "</suite>", WATCHED)
    # On a busy machine, the cable would break before the motion.
    change(copy / "loose_arm.py", "DIES_AFTER_SECS = 4.0", "DIES_AFTER_SECS = 1e4")
    run = Run(rtf, f"{copy / SUITE.name}::SweepTest", tmp_path / "monitored")
    expect("exit code", run.wait(), 1)
    expect("verdicts", run.attempts(), ["failed"])
    expect("cause", [event["cause"] for event in run.events("test-stopping")], ["finding"])
    expect_in("monitor `stays low`: `0.5rad > shoulder` does not hold", run.reason("test-stopping"))
    # Nothing moves it afterwards, so that the hook does not run at the end.
    expect("hooks", triggers(run), ["failure"])
    expect("parked", "parked: " in hook_output(run), True)
    expect("it was stopped in the middle", seconds_until(run, "hook-started") < SWEEP_SECS, True)
    batches = [event["samples"]["points"] for event in run.events("sampled")]
    values = [value for points in batches for _, value in points]
    expect("the arm was beyond the limit", max(values) > LIMIT_RAD, True)
    expect("arms left", arms(), [])


def change(file: Path, old: str, new: str) -> None:
    """Replaces a text in a file."""
    text = file.read_text()
    expect(f"`{old}` in {file.name}", old in text, True)
    file.write_text(text.replace(old, new))


def seconds_until(run: Run, kind: str) -> float:
    """The time from the start of the first test to the first event of this kind."""
    started, reached = (next(run.events(each))["at"] for each in ("test-started", kind))
    return float(reached - started) / 1e6


def is_rerun(event: Event) -> bool:
    """Whether the test that the collapse interrupted is rerun."""
    return is_a(event, "test-started") and bool(event["attempt"] == 2)


def runs_again(run: Run) -> bool:
    """Whether the second attempt has reached the phase `run`."""
    events = list(run.events())
    again = next(index for index, event in enumerate(events) if is_rerun(event))
    return any(is_a(each, "test-phase") and each["phase"] == "run" for each in events[again:])


def triggers(run: Run) -> list[str]:
    """The triggers of the hook, in order."""
    return [event["trigger"] for event in run.events("hook-started")]


def hook_output(run: Run) -> str:
    """The output of the hook."""
    return "".join(event["text"] for event in run.events("output") if "hook" in event["source"])


def arms() -> list[int]:
    """The running simulators of this lesson."""
    return running("loose_arm.py")
