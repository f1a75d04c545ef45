#!/usr/bin/env python3
"""Runs YARP's fixtures while parts hang or do not start, and two of them in parallel.

    check_fixture_yarp.py RTF DIRECTORY

All programs are YARP's own. check_example_03.py kills them.
"""

from __future__ import annotations

import os
import signal
import sys
import tarfile
import tempfile
from pathlib import Path

import network
from check_example_03 import Lesson
from processes import kill
from run import expect, expect_in

HEAD = "/icubSim/head/state:o"


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, suites = (Path(argument).resolve() for argument in sys.argv[1:])
    network.move_in()
    with tempfile.TemporaryDirectory() as name, network.quiet("YARP's fixtures"):
        lesson = Lesson(str(rtf), suites, Path(name))
        hangs(lesson, "probe", "yarpdev", f"the port {HEAD} does not answer at 127.0.0.1:")
        hangs(lesson, "application", "yarpdev", f"{HEAD} -> /reader is lost: the port {HEAD}")
        does_not_start(lesson, "broken", "Could not find device <noSuchDevice>")
        does_not_start(lesson, "missing", "cannot run no-such-module on localhost")
        ends_badly(lesson)
        in_parallel(lesson)
        recorded(lesson)
        as_in_yarp(lesson)
        is_installed(lesson)
    return 0


def hangs(lesson: Lesson, suite: str, program: str, expected: str) -> None:
    """A process that exists but does not answer is a collapse with that reason."""
    run = lesson.start(f"{suite}.xml", f"{suite}-hangs")
    run.disturb(lambda: kill(lesson.processes(program), signal.SIGSTOP))
    expect("exit code", run.wait(), 1)
    expect("verdicts", list(run.verdicts().values()), ["collapsed"])
    expect_in(expected, run.reason())
    lesson.nothing_left()


def does_not_start(lesson: Lesson, application: str, expected: str) -> None:
    """A module that the manager cannot start fails the set-up without waiting for its time-outs."""
    run = lesson.start("application.xml", application, f"--set=application={application}")
    expect("exit code", run.wait(), 1)
    expect("skipped", len(list(run.events("test-skipped"))), 1)
    expect_in(expected, run.reason("fixture-broken"))
    lesson.nothing_left()


def ends_badly(lesson: Lesson) -> None:
    """Modules that end badly when they are stopped make the run red; the manager ignores it."""
    run = lesson.start("ending.xml", "ends-badly")
    expect("exit code", run.wait(), 1)
    expect("verdicts", list(run.verdicts().values()), ["passed"])
    (problem,) = run.problems()
    expect_in("module `python3 ../ending.py 3` ended with exit code 3 after SIGTERM", problem)
    expect_in("module `python3 ../ending.py 11` was killed by SIGSEGV after SIGTERM", problem)
    expect("the module that ended well", "ending.py 0" in problem, False)
    lesson.nothing_left()
    run = lesson.start("ending.xml", "may-die", "--set=options=--may-die python3")
    expect("exit code", run.wait(), 0)
    lesson.nothing_left()


def in_parallel(lesson: Lesson) -> None:
    """Two suites with the same application in one network, in separate YARP namespaces."""
    run = lesson.start("left.xml", "in parallel", "--jobs", "2", str(lesson.example / "right.xml"))
    expect("exit code", run.wait(), 0)
    expect("verdicts", run.attempts(), ["passed", "passed"])
    servers: dict[int, dict[str, object]] = {}
    for event in run.events("fixture-provided"):
        servers.setdefault(event["fixture"], {})[event["name"]] = event["value"]
    spaces = {str(values["namespace"]) for values in servers.values()}
    expect("private namespaces", len(spaces), 2)
    for values in servers.values():
        number = int(str(values["namespace"]).removeprefix("/rtf"))
        expected = {"host": "127.0.0.1", "port": 10000 + 100 * number, "namespace": f"/rtf{number}"}
        expect("values of yarpserver", values, expected)
    lesson.nothing_left()


def recorded(lesson: Lesson) -> None:
    """The data of a port during a failed test is attached to that test, and nothing else."""
    run = lesson.start("recorder.xml", "recorder")
    expect("exit code", run.wait(), 1)
    expect("verdicts", run.verdicts(), {"bad": "failed", "good": "passed"})
    (kept,) = run.events("attached")
    expect("test with the recording", run.name(kept), "bad")
    with tarfile.open(run.journal.parent / kept["attachment"]["path"]) as archive:
        names = {Path(name).name for name in archive.getnames()}
        expect("files", {"data.log", "info.log"} <= names, True)
        (data,) = [name for name in archive.getnames() if name.endswith("data.log")]
        lines = (archive.extractfile(data) or sys.exit(f"no {data}")).read().decode().splitlines()
    # A number, a time stamp, and six encoders.
    expect("enough lines", len(lines) > 10, True)
    expect("numbers in a line", {len(line.split()) for line in lines}, {8})
    lesson.nothing_left()


def as_in_yarp(lesson: Lesson) -> None:
    """`--fixture head.xml` is found as by YARP's own plug-in: in a context of YARP's data."""
    data = lesson.example.parent / "data"
    os.environ["YARP_DATA_DIRS"] = f"{os.environ['YARP_DATA_DIRS']}:{data}"
    run = lesson.start("predecessor.xml", "predecessor")
    expect("exit code", run.wait(), 0)
    expect("verdicts", list(run.verdicts().values()), ["passed"])
    lesson.nothing_left()


def is_installed(lesson: Lesson) -> None:
    """Items that YARP lists are found; all others are named."""
    run = lesson.start("plugins.xml", "plugins")
    expect("exit code", run.wait(), 0)
    absent = "--set=monitor=remote_controlboard"
    run = lesson.start("plugins.xml", "absent", absent, "--set=carriers=tcp shmem")
    expect("exit code", run.wait(), 1)
    expected = "YARP does not have portmonitors: remote_controlboard, carriers: shmem"
    expect_in(expected, run.reason("fixture-broken"))


if __name__ == "__main__":
    sys.exit(main())
