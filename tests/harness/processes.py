"""Processes of this machine and their leftover shared memory, for checks."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Callable
from pathlib import Path

MARK = "RTF_CHECK"
"""A variable with the name of the test, which all that it starts inherits; tests/conftest.py."""


def select(wanted: Callable[[Path, list[str], list[str]], bool]) -> list[int]:
    """The processes whose directory in /proc, command line and environment are wanted.

    Excludes zombies, processes of other users, and this process.
    """
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            words = lines(entry / "cmdline")
            is_wanted = any(words) and wanted(entry, words, lines(entry / "environ"))
        except OSError:  # it has exited, or belongs to another user
            continue
        if is_wanted and int(entry.name) != os.getpid():
            found.append(int(entry.name))
    return sorted(found)


def lines(file: Path) -> list[str]:
    """The parts of a file that are terminated by zero bytes."""
    return file.read_bytes().decode(errors="replace").removesuffix("\0").split("\0")


def running(program: str) -> list[int]:
    """The processes whose program or script has this name, which this test has started."""
    mark = f"{MARK}={os.environ[MARK]}"

    def is_ours(_: Path, words: list[str], environment: list[str]) -> bool:
        return program in {Path(word).name for word in words[:2]} and mark in environment

    return select(is_ours)


def children(pid: int) -> list[int]:
    """The children of a process."""
    tasks = Path(f"/proc/{pid}/task").glob("*/children")
    return [int(child) for task in tasks for child in task.read_text().split()]


def parent(pid: int) -> int:
    """The parent of a process."""
    stat = Path(f"/proc/{pid}/stat").read_text()
    return int(stat.rpartition(")")[2].split()[1])


def variable(pid: int, name: str) -> str:
    """The value of a variable in a process's environment."""
    pairs = (line.partition("=") for line in lines(Path(f"/proc/{pid}/environ")))
    return next(value for key, _, value in pairs if key == name)


def commands(pids: list[int]) -> list[str]:
    """The command lines of processes that still exist."""
    found = []
    for pid in pids:
        with contextlib.suppress(OSError):
            found.append(" ".join(lines(Path(f"/proc/{pid}/cmdline"))))
    return found


def kill(pids: list[int], number: signal.Signals = signal.SIGKILL) -> None:
    """Sends a signal to a process, which must be the only one."""
    (pid,) = pids
    os.kill(pid, number)
