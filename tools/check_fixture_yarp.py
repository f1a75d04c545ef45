#!/usr/bin/env python3
"""Runs YARP's fixtures while parts hang or do not start, and two of them side by side.

    check_fixture_yarp.py RTF FOLDER

All programs are YARP's own. What happens when they are killed is in check_example_03.py.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

from check_example_01 import expect, is_a
from check_example_03 import Lesson

HEAD = "/icubSim/head/state:o"


def main() -> int:
    """Runs all and tells the first thing that is not as it should be."""
    rtf, suites = (Path(argument).resolve() for argument in sys.argv[1:])
    with tempfile.TemporaryDirectory() as name:
        lesson = Lesson(str(rtf), suites, Path(name))
        hangs(lesson, "probe", "yarpdev", f"the port {HEAD} does not answer at 127.0.0.1:")
        hangs(lesson, "application", "yarpdev", f"{HEAD} -> /reader is lost: the port {HEAD}")
        does_not_start(lesson, "broken", "Could not find device <noSuchDevice>")
        does_not_start(lesson, "missing", "cannot run no-such-module on localhost")
        side_by_side(lesson)
        recorded(lesson)
    return 0


def hangs(lesson: Lesson, suite: str, program: str, expected: str) -> None:
    """A process that is there, but does not answer, is a collapse that says so."""
    run = lesson.start(f"{suite}.xml", f"{suite}-hangs")
    try:
        run.wait_for(lambda event: is_a(event, "test-phase") and event["phase"] == "run")
        (pid,) = lesson.processes(program)
        os.kill(pid, signal.SIGSTOP)
    except BaseException:
        run.stop()
        raise
    expect("exit code", run.wait(), 1)
    expect("verdicts", list(run.verdicts().values()), ["collapsed"])
    (reason,) = [event["reason"] for event in run.events() if is_a(event, "fixture-collapsed")]
    expect(f"`{expected}` in {reason!r}", expected in reason, True)
    lesson.nothing_left()


def does_not_start(lesson: Lesson, application: str, expected: str) -> None:
    """What the manager cannot start makes the set-up fail, and not only after its time-outs."""
    run = lesson.start("application.xml", application, f"--set=application={application}")
    expect("exit code", run.wait(), 1)
    expect("skipped", len([1 for event in run.events() if is_a(event, "test-skipped")]), 1)
    (reason,) = [event["reason"] for event in run.events() if is_a(event, "fixture-broken")]
    expect(f"`{expected}` in {reason!r}", expected in reason, True)
    lesson.nothing_left()


def side_by_side(lesson: Lesson) -> None:
    """Two suites with the same application, in one network, each in a namespace of its own."""
    folder = lesson.folder / "both"
    private = ["unshare", "--net"] if os.geteuid() == 0 else ["unshare", "--net", "--map-root-user"]
    suites = [str(lesson.example / f"{name}.xml") for name in ("left", "right")]
    command = [lesson.rtf, "run", "--jobs", "2", "--results", str(folder), *suites]
    script = 'ip link set lo up && exec "$@"'
    print("--- side by side", flush=True)
    done = subprocess.run([*private, "sh", "-c", script, "sh", *command], check=False, timeout=120)
    expect("exit code", done.returncode, 0)
    lesson.nothing_left()


def recorded(lesson: Lesson) -> None:
    """What went through a port during a test that failed is kept with it, and only that."""
    run = lesson.start("recorder.xml", "recorder")
    expect("exit code", run.wait(), 1)
    expect("verdicts", run.verdicts(), {"bad": "failed", "good": "passed"})
    (kept,) = [event for event in run.events() if is_a(event, "attached")]
    expect("test that it belongs to", run.name(kept), "bad")
    with tarfile.open(run.journal.parent / kept["attachment"]["path"]) as archive:
        names = {Path(name).name for name in archive.getnames()}
        expect("files", {"data.log", "info.log"} <= names, True)
        (data,) = [name for name in archive.getnames() if name.endswith("data.log")]
        lines = (archive.extractfile(data) or sys.exit(f"no {data}")).read().decode().splitlines()
    # A number, a time stamp, and six encoders.
    expect("enough lines", len(lines) > 10, True)
    expect("numbers in a line", {len(line.split()) for line in lines}, {8})
    lesson.nothing_left()


if __name__ == "__main__":
    sys.exit(main())
