#!/usr/bin/env python3
"""Runs example 03 as a user does, and while parts of the robot are killed.

    check_example_03.py RTF DIRECTORY

DIRECTORY is that of the example. The environment must be set up as the lesson says. A
module, the name server and the fixture get a SIGKILL, and YARP's tool cuts a connection. No
packet may leave the machine.
"""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import network
from pages import run_fixture_page
from processes import kill, parent, select
from run import Run, expect, expect_in

VICTIM = "StreamTest"
CONNECTION = "/sensor/values:o -> /smoother/values:i"


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, example = (Path(argument).resolve() for argument in sys.argv[1:])
    network.move_in()
    with tempfile.TemporaryDirectory() as name, network.quiet("lesson 3"):
        lesson = Lesson(str(rtf), example, Path(name))
        lesson.undisturbed("first_generation.xml", 2)
        lesson.undisturbed("yarp.xml", 3)
        lesson.disturbed("module", kill_sensor, ["module `sensor --name /sensor`"])
        lesson.disturbed("connection", cut_connection, [CONNECTION, "does not send"])
        lesson.disturbed("server", stop_server, ["yarpserver was killed by SIGKILL"])
        lesson.disturbed("fixture", kill_fixture, ["SIGKILL"])
        for page in ("yarpserver", "yarpmanager", "yarpplugin", "yarpdatadumper"):
            run_fixture_page(str(rtf), page, Path(name) / page, example)
            lesson.nothing_left()
    return 0


class Lesson:
    """The example, with a private home directory for YARP's files."""

    def __init__(self, rtf: str, example: Path, directory: Path) -> None:
        self.rtf = rtf
        self.example = example
        self.directory = directory
        self.home = directory / "home"
        # Identifies the processes of the runs.
        os.environ["YARP_CONFIG_HOME"] = str(self.home)

    def undisturbed(self, suite: str, tests: int) -> None:
        """All tests pass, on loopback only, and no process is left."""
        run = self.start(suite, suite)
        expect("exit code", run.wait(), 0)
        expect("verdicts", list(run.verdicts().values()), ["passed"] * tests)
        self.nothing_left()

    def disturbed(
        self, what: str, disturb: Callable[[Lesson, Run], None], expected: list[str]
    ) -> None:
        """The running test is `collapsed`, the reason names the lost part, and the others pass."""
        run = self.start("yarp.xml", what)

        def do() -> None:
            expect("interfaces", interfaces(run), ["lo"])
            disturb(self, run)

        noticed = run.collapses(do, VICTIM)
        expect("exit code", run.wait(), 1)
        expect("seconds until the collapse was detected, below 3", noticed < 3, True)
        verdicts = run.verdicts()
        expect(f"verdict of {VICTIM}", verdicts.pop(VICTIM), "collapsed")
        expect("other verdicts", list(verdicts.values()), ["passed", "passed"])
        for text in expected:
            expect_in(text, run.reasons()[0])
        self.nothing_left()

    def start(self, suite: str, name: str, *options: str) -> Run:
        """Starts a run of a suite."""
        print(f"--- {name}", flush=True)
        return Run(self.rtf, str(self.example / suite), self.directory / f"{name}.run", *options)

    def processes(self, program: str = "") -> list[int]:
        """The processes of the runs, or those of a program, without zombies."""
        mark = f"YARP_CONFIG_HOME={self.home}"
        return select(
            lambda _, words, variables: (
                mark in variables and (not program or Path(words[0]).name == program)
            )
        )

    def nothing_left(self) -> None:
        """No process is left, and no address of a dead name server."""
        expect("processes left", self.processes(), [])
        expect("files left", [str(path) for path in self.home.rglob("*") if path.is_file()], [])


def kill_sensor(lesson: Lesson, run: Run) -> None:
    """A module of the robot dies."""
    del run
    kill(lesson.processes("sensor"))


def cut_connection(lesson: Lesson, run: Run) -> None:
    """A connection is cut."""
    del lesson
    source, target = CONNECTION.split(" -> ")
    (join,) = [event["join_command"] for event in run.events("suite-prepared")]
    words = [word for word in shlex.split(join) if word != "${SHELL:-sh}"]
    subprocess.run([*words, "yarp", "disconnect", source, target], check=True, timeout=30)


def stop_server(lesson: Lesson, run: Run) -> None:
    """The name server dies."""
    del run
    kill(lesson.processes("yarpserver"))


def kill_fixture(lesson: Lesson, run: Run) -> None:
    """The plug-in that runs YARP's manager dies."""
    del run
    (manager,) = lesson.processes("yarpmanager-console")
    kill([parent(manager)])


def interfaces(run: Run) -> list[str]:
    """The network interfaces that are visible to the suite's processes."""
    (network,) = [event["network"] for event in run.events("suite-prepared")]
    lines = Path(f"/proc/{network['pid']}/net/dev").read_text().splitlines()[2:]
    return [line.split(":")[0].strip() for line in lines]


if __name__ == "__main__":
    sys.exit(main())
