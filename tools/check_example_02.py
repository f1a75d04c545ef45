#!/usr/bin/env python3
"""Runs example 02 as a user does, and a second time while the runner is killed.

    check_example_02.py RTF SUITE

The first run shows a collapse, a rerun and a parked arm. In the second, the runner gets a
SIGKILL while the arm moves, and the guard must park the arm.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from processes import children, kill, running
from run import Event, Run, expect, is_a

RUNNER_DIED = 5


def main() -> int:
    """Runs both; exits at the first difference."""
    rtf, suite = (str(Path(argument).resolve()) for argument in sys.argv[1:])
    with tempfile.TemporaryDirectory() as directory:
        undisturbed(rtf, suite, Path(directory) / "undisturbed")
        runner_killed(rtf, suite, Path(directory) / "killed")
    return 0


def undisturbed(rtf: str, suite: str, directory: Path) -> None:
    """The arm dies once, the test is rerun, and the arm is parked at the end."""
    run = Run(rtf, suite, directory)
    expect("exit code", run.wait(), 0)
    expect("attempts", run.attempts(), ["collapsed", "passed", "passed"])
    expect("hooks", triggers(run), ["collapse", "end"])
    expect("parked", "parked: " in hook_output(run), True)
    expect("arms left", arms(), [])


def runner_killed(rtf: str, suite: str, directory: Path) -> None:
    """The guard parks the arm, and no process is left."""
    run = Run(rtf, suite, directory)
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


if __name__ == "__main__":
    sys.exit(main())
