"""Plays the host of `rtf-host-framework`: starts a program with `RTF_SESSION`."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from driver import LIMIT_SECONDS, PACKAGE

if TYPE_CHECKING:
    from collections.abc import Collection

PYTEST_OPTIONS = ("-p", "no:cacheprovider", "-p", "rtf.frameworks.pytest_plugin")
PYTEST = ("-m", "rtf_start", "pytest", *PYTEST_OPTIONS)
UNITTEST = ("-m", "rtf_start", "rtf.frameworks.unittest_runner")

VALUES = [{"name": "simulator.port", "value": 40123}]


class SessionHost:
    """A program that has ended, and the packets that it sent."""

    def __init__(self, directory: Path, *arguments: str, dropped: Collection[str] = ()) -> None:
        """Run `python3 ARGUMENT…`; the cases `dropped` do not run."""
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.packets: list[dict[str, Any]] = []
        self._socket = ours
        self._dropped = dropped
        self.stack_file = directory / "stacks"
        # The sessions of the tests' own runner do not concern the program.
        environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST_")}
        environment |= {
            "PYTHONPATH": str(PACKAGE),
            "RTF_SESSION": f"fd:{theirs.fileno()}",
            "RTF_STACK_FILE": str(self.stack_file),
        }
        # Not a pipe, which is full after 64 KiB.
        output = directory / "output"
        with output.open("wb") as stream:
            self.process = subprocess.Popen(
                [sys.executable, *arguments],
                cwd=directory,
                env=environment,
                pass_fds=[theirs.fileno()],
                stdout=stream,
                stderr=subprocess.STDOUT,
            )
        theirs.close()
        ours.settimeout(LIMIT_SECONDS)
        while packet := ours.recv(1 << 18):
            assert len(packet) <= 65536
            self._answer(json.loads(packet))
        self.code = self.process.wait(LIMIT_SECONDS)
        self.output = output.read_text(encoding="utf-8", errors="replace")
        ours.close()

    def _answer(self, packet: dict[str, Any]) -> None:
        self.packets.append(packet)
        params = packet["params"]
        if packet.get("answer") is False:
            return
        if packet["method"] == "cases-planned":
            names = params["names"]
            self._socket.send(b"".join(b"1" if n in self._dropped else b"0" for n in names))
        elif packet["method"] == "fixture-values":
            self._socket.send(json.dumps(VALUES).encode())
        else:
            self._socket.send(b"0")

    def of(self, method: str) -> list[dict[str, Any]]:
        """Return the parameters of all packets of a method."""
        return [packet["params"] for packet in self.packets if packet["method"] == method]

    def results(self) -> dict[str, str]:
        """Return the outcome of each case: as reported, or the first problem's kind."""
        results = {}
        for finished in self.of("case-finished"):
            name = finished["name"]
            kinds = [m["kind"] for m in self.of("message") if m.get("case") == name]
            problems = [kind for kind in kinds if kind in ("failure", "error")]
            results[name] = (problems or [finished.get("outcome", "passed")])[0]
        return results

    def planned(self) -> list[str]:
        """Return all planned names."""
        return [name for plan in self.of("cases-planned") for name in plan["names"]]


def listed(directory: Path, *arguments: str) -> list[dict[str, Any]]:
    """Return the lines of a list."""
    file = directory / "list"
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE), "RTF_LISTING": str(file)}
    subprocess.run(
        [sys.executable, *arguments],
        cwd=directory,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        timeout=LIMIT_SECONDS,
        check=False,
    )
    return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
