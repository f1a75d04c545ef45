#!/usr/bin/env python3
"""Runs example 01 as a user does, and once more while its simulator is killed.

    check_example_01.py RTF SUITE

Nothing is imitated: the process that steps the physics gets a SIGKILL in the
middle of a test. Both runs are judged by their exit code and their journal.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

Event = dict[str, Any]

RUN_SECS = 120
"""A run takes some ten seconds; a machine that does other things gets time."""

VICTIM = "AccuracyTest"


def main() -> int:
    """Runs both and tells the first thing that is not as it should be."""
    rtf, suite = (str(Path(argument).resolve()) for argument in sys.argv[1:])
    with tempfile.TemporaryDirectory() as folder:
        undisturbed(rtf, suite, Path(folder) / "undisturbed")
        simulator_killed(rtf, suite, Path(folder) / "killed")
    return 0


def undisturbed(rtf: str, suite: str, folder: Path) -> None:
    """Everything passes, and nothing is left running."""
    run = Run(rtf, suite, folder)
    code = run.wait()
    expect("exit code", code, 0)
    expect("verdicts", set(run.verdicts().values()), {"passed"})
    expect("tests", len(run.verdicts()), 3)
    measured = {event["measurement"]["name"] for event in run.events() if is_a(event, "measured")}
    expect("measured", {"worst error", "sampling rate"} <= measured, True)
    expect("simulators left", simulators(suite), [])


def simulator_killed(rtf: str, suite: str, folder: Path) -> None:
    """The running test is `collapsed`, within a second; the others pass."""
    run = Run(rtf, suite, folder)
    try:
        run.wait_for(
            lambda event: (
                is_a(event, "test-phase") and run.name(event) == VICTIM and event["phase"] == "run"
            )
        )
        (pid,) = simulators(suite)
        os.kill(pid, signal.SIGKILL)
        killed = time.monotonic()
        run.wait_for(lambda event: is_a(event, "fixture-collapsed"))
        noticed = time.monotonic() - killed
    except BaseException:
        run.stop()
        raise
    code = run.wait()
    expect("exit code", code, 1)
    expect("seconds until the collapse was seen, below 1", noticed < 1, True)
    verdicts = run.verdicts()
    expect(f"verdict of {VICTIM}", verdicts.pop(VICTIM), "collapsed")
    expect("other verdicts", sorted(verdicts.values()), ["passed", "passed"])
    starts = [event for event in run.events() if is_a(event, "fixture-ready")]
    expect("starts of the simulator", len(starts), 2)
    (reason,) = [event["reason"] for event in run.events() if is_a(event, "fixture-collapsed")]
    expect(f"SIGKILL in `{reason}`", "SIGKILL" in reason or "signal 9" in reason, True)
    expect("simulators left", simulators(suite), [])


class Run:
    """A run of rtf and its journal."""

    def __init__(self, rtf: str, suite: str, folder: Path, *options: str) -> None:
        folder.mkdir()
        self.journal = folder / "latest" / "events.jsonl"
        self.output = folder / "output"
        with self.output.open("wb") as output:
            self.process = subprocess.Popen(
                [rtf, "run", "--results", str(folder), *options, suite],
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
            )

    def wait(self) -> int:
        """The exit code; what rtf printed goes to the output."""
        try:
            return self.process.wait(RUN_SECS)
        finally:
            self.stop()
            print(self.output.read_text(errors="replace"), flush=True)

    def stop(self) -> None:
        """Ends the run if it has not ended."""
        if self.process.poll() is None:
            self.process.terminate()
            self.process.wait()

    def events(self) -> Iterator[Event]:
        """What is in the journal; its last line may still be half written."""
        if self.journal.exists():
            for line in self.journal.read_text().splitlines(keepends=True):
                if line.endswith("\n"):
                    yield json.loads(line)

    def wait_for(self, condition: Any) -> None:
        """Waits until an event of the run fulfils the condition."""
        deadline = time.monotonic() + RUN_SECS
        while not any(condition(event) for event in self.events()):
            if self.process.poll() is not None or time.monotonic() > deadline:
                self.wait()
                raise SystemExit("the run ended, or hangs, before what was waited for")
            time.sleep(0.02)

    def name(self, event: Event) -> str:
        """The name of the test that an event is about."""
        names = {each["test"]: each["name"] for each in self.events() if is_a(each, "test-planned")}
        return str(names[event["test"]])

    def verdicts(self) -> dict[str, str]:
        """The last verdict of each test."""
        return {
            self.name(event): event["verdict"]
            for event in self.events()
            if is_a(event, "test-finished")
        }


def is_a(event: Event, kind: str) -> bool:
    """Whether the event is of this kind."""
    return bool(event["type"] == kind)


def simulators(suite: str) -> list[int]:
    """The processes that are simulators of this suite and not zombies."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes().split(b"\0")
            if b"simulator.py" in words and (folder / "cwd").resolve() == Path(suite).parent:
                found.append(int(folder.name))
        except OSError:  # it has ended, or it is not ours
            continue
    return found


def expect(what: str, got: object, expected: object) -> None:
    """Ends with a message if something is not as expected."""
    if got != expected:
        raise SystemExit(f"{what}: got {got}, expected {expected}")
    print(f"ok: {what}: {got}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
