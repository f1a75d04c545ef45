#!/usr/bin/env python3
"""Runs example 02 as a user does, and once more while the runner is killed.

    check_example_02.py RTF SUITE

The first run shows a collapse, a rerun and a parked arm. In the second one the
runner gets a SIGKILL while the arm moves: its guard has to park the arm.
"""

from __future__ import annotations

import os
import signal
import sys
import tempfile
from pathlib import Path

from check_example_01 import Event, Run, expect, is_a

RUNNER_DIED = 5


def main() -> int:
    """Runs both and tells the first thing that is not as it should be."""
    rtf, suite = (str(Path(argument).resolve()) for argument in sys.argv[1:])
    with tempfile.TemporaryDirectory() as folder:
        undisturbed(rtf, suite, Path(folder) / "undisturbed")
        runner_killed(rtf, suite, Path(folder) / "killed")
    return 0


def undisturbed(rtf: str, suite: str, folder: Path) -> None:
    """The arm dies once, the test runs again, and the arm ends up parked."""
    run = Run(rtf, suite, folder)
    expect("exit code", run.wait(), 0)
    attempts = [event["verdict"] for event in run.events() if is_a(event, "test-finished")]
    expect("attempts", attempts, ["collapsed", "passed", "passed"])
    expect("hooks", triggers(run), ["collapse", "end"])
    expect("parked", "parked: " in hook_output(run), True)
    expect("arms left", arms(), [])


def runner_killed(rtf: str, suite: str, folder: Path) -> None:
    """The guard parks the arm and leaves nothing running."""
    run = Run(rtf, suite, folder)
    try:
        run.wait_for(is_rerun)
        run.wait_for(lambda event: is_a(event, "test-phase") and runs_again(run))
        (runner,) = children(run.process.pid)
        os.kill(runner, signal.SIGKILL)
    except BaseException:
        run.stop()
        raise
    expect("exit code", run.wait(), RUNNER_DIED)
    last = list(run.events())[-1]
    expect("last event", last["type"], "runner-died")
    expect("hooks", triggers(run), ["collapse", "interrupt"])
    expect("parked", "parked: " in hook_output(run), True)
    expect("arms left", arms(), [])


def is_rerun(event: Event) -> bool:
    """Whether the test that was interrupted by the collapse begins again."""
    return is_a(event, "test-started") and bool(event["attempt"] == 2)


def runs_again(run: Run) -> bool:
    """Whether the second attempt has entered its run."""
    events = list(run.events())
    again = next(index for index, event in enumerate(events) if is_rerun(event))
    return any(is_a(each, "test-phase") and each["phase"] == "run" for each in events[again:])


def triggers(run: Run) -> list[str]:
    """What called for a hook, in order."""
    return [event["trigger"] for event in run.events() if is_a(event, "hook-started")]


def hook_output(run: Run) -> str:
    """What the hook printed."""
    outputs = (event for event in run.events() if is_a(event, "output"))
    return "".join(event["text"] for event in outputs if "hook" in event["source"])


def children(pid: int) -> list[int]:
    """The processes that a process has started."""
    tasks = Path(f"/proc/{pid}/task").glob("*/children")
    return [int(child) for task in tasks for child in task.read_text().split()]


def arms() -> list[int]:
    """The simulators of this lesson that run."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if b"loose_arm.py" in (folder / "cmdline").read_bytes().split(b"\0"):
                found.append(int(folder.name))
        except OSError:  # it has ended
            continue
    return found


if __name__ == "__main__":
    sys.exit(main())
