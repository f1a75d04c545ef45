"""Runs of suites with YARP, with a private home directory for YARP's files."""

from __future__ import annotations

import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

import network
import pytest
from processes import select
from run import RUN_SECS, Run, expect

SERVER = ("127.0.0.1", 10000)
"""YARP's usual port. Each of these tests has a private network."""


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

    @contextmanager
    def name_server(self) -> Iterator[None]:
        """A name server in YARP's usual namespace, as a user starts one; a run leaves it alone."""
        self.home.mkdir(exist_ok=True)
        address = self.home / "yarp.conf"
        # With `--write` it would write the address of the network's other interface.
        content = f"{SERVER[0]} {SERVER[1]} yarp\n"
        address.write_text(content)
        options = ["--read", "--silent", "--ip", SERVER[0], "--socket", str(SERVER[1])]
        with subprocess.Popen(["yarpserver", *options], stdout=subprocess.DEVNULL) as server:
            try:
                wait_for_port()
                yield
                expect("the name server has ended", server.poll(), None)
                expect("its address", address.read_text(), content)
            finally:
                server.terminate()
        address.unlink()

    def nothing_left(self) -> None:
        """No process is left, and no address of a dead name server."""
        expect("processes left", self.processes(), [])
        expect("files left", [str(path) for path in self.home.rglob("*") if path.is_file()], [])


def wait_for_port() -> None:
    """Waits until the name server accepts connections."""
    deadline = time.monotonic() + RUN_SECS
    while True:
        with socket.socket() as client:
            if client.connect_ex(SERVER) == 0:
                return
        assert time.monotonic() < deadline, "the name server does not listen"
        time.sleep(0.02)


@contextmanager
def quiet_runs(rtf: str, suites: Path, directory: Path) -> Iterator[YarpRuns]:
    """Runs that leave nothing; within the test's network, no packet may leave the machine."""
    runs = YarpRuns(rtf, suites, directory)
    with pytest.MonkeyPatch.context() as patch:
        # Identifies the processes of the runs.
        patch.setenv("YARP_CONFIG_HOME", str(runs.home))
        with network.quiet("YARP") if network.is_inside() else nullcontext():
            yield runs
