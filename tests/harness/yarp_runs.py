"""Runs of suites with YARP, with a private home directory for YARP's files."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

import network
import pytest
from processes import select
from run import Run, expect


class YarpRuns:
    """Runs of the suites in a directory."""

    def __init__(self, rtf: str, suites: Path, directory: Path) -> None:
        self.rtf = rtf
        self.suites = suites
        self.directory = directory
        self.home = directory / "home"

    def start(self, suite: str, name: str = "run", *options: str) -> Run:
        """Starts a run of a suite."""
        return Run(self.rtf, str(self.suites / suite), self.directory / f"{name}.run", *options)

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


@contextmanager
def quiet_runs(rtf: str, suites: Path, directory: Path) -> Iterator[YarpRuns]:
    """Runs that leave nothing; within the test's network, no packet may leave the machine."""
    runs = YarpRuns(rtf, suites, directory)
    with pytest.MonkeyPatch.context() as patch:
        # Identifies the processes of the runs.
        patch.setenv("YARP_CONFIG_HOME", str(runs.home))
        with network.quiet("YARP") if network.is_inside() else nullcontext():
            yield runs
