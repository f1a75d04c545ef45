"""Runs for some seconds, and measures the processes that record signals during this time."""

from __future__ import annotations

import os
import time
from pathlib import Path

import rtf

RECORDER = "rtf-host-signals"
TICKS = os.sysconf("SC_CLK_TCK")


class SignalLoad(rtf.TestCase):
    """Its parameter is the number of seconds."""

    def setup(self, args: list[str]) -> None:
        self.seconds = float(args[0])
        mark = f"RTF_RUN_DIR={os.environ['RTF_RUN_DIR']}".encode()
        self.recorder = next(pid for pid in recorders() if mark in environment(pid))
        self.runner = int(status(self.recorder, "PPid"))

    def run(self) -> None:
        processes = {"recorder": self.recorder, "runner": self.runner}
        before = {name: processor_secs(pid) for name, pid in processes.items()}
        start = time.monotonic()
        self.sleep(self.seconds)
        elapsed = time.monotonic() - start
        for name, pid in processes.items():
            used = processor_secs(pid) - before[name]
            self.measure(f"{name}, processor", 100 * used / elapsed, "%")
            memory = int(status(pid, "VmHWM").split()[0]) * 1024 / 1e6
            self.measure(f"{name}, memory", memory, "MB")


def recorders() -> list[int]:
    """The processes that record signals, of any run."""
    entries = (entry for entry in Path("/proc").iterdir() if entry.name.isdigit())
    return [int(entry.name) for entry in entries if command(entry).endswith(RECORDER)]


def command(process: Path) -> str:
    """The program of a process; empty if it has ended."""
    try:
        return (process / "cmdline").read_bytes().split(b"\0")[0].decode()
    except OSError:
        return ""


def environment(pid: int) -> list[bytes]:
    """The variables of a process."""
    return Path(f"/proc/{pid}/environ").read_bytes().split(b"\0")


def status(pid: int, field: str) -> str:
    """A field of the status of a process."""
    lines = Path(f"/proc/{pid}/status").read_text(encoding="utf-8").splitlines()
    return next(line.split(":", 1)[1].strip() for line in lines if line.startswith(f"{field}:"))


def processor_secs(pid: int) -> float:
    """User and system time of a process."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS
