"""The processes of this machine, and the shared memory that they leave, for checks."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Callable
from pathlib import Path


def select(wanted: Callable[[Path, list[str], list[str]], bool]) -> list[int]:
    """The processes for whose directory in /proc, words and environment this holds.

    Those are left out that have ended and only wait for their parent, that belong to somebody
    else, and this one.
    """
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            words = lines(entry / "cmdline")
            is_wanted = any(words) and wanted(entry, words, lines(entry / "environ"))
        except OSError:  # it has ended, or it is not ours
            continue
        if is_wanted and int(entry.name) != os.getpid():
            found.append(int(entry.name))
    return sorted(found)


def lines(file: Path) -> list[str]:
    """What stands in a file whose parts end with a zero."""
    return file.read_bytes().decode(errors="replace").removesuffix("\0").split("\0")


def running(program: str) -> list[int]:
    """The processes whose program, or script, has this name."""
    return select(lambda _, words, __: program in {Path(word).name for word in words[:2]})


def children(pid: int) -> list[int]:
    """The processes that a process has started."""
    tasks = Path(f"/proc/{pid}/task").glob("*/children")
    return [int(child) for task in tasks for child in task.read_text().split()]


def parent(pid: int) -> int:
    """The process that has started this one."""
    stat = Path(f"/proc/{pid}/stat").read_text()
    return int(stat.rpartition(")")[2].split()[1])


def variable(pid: int, name: str) -> str:
    """The value of a variable in a process's environment."""
    pairs = (line.partition("=") for line in lines(Path(f"/proc/{pid}/environ")))
    return next(value for key, _, value in pairs if key == name)


def commands(pids: list[int]) -> list[str]:
    """The command lines of processes, as far as they are there still."""
    told = []
    for pid in pids:
        with contextlib.suppress(OSError):
            told.append(" ".join(lines(Path(f"/proc/{pid}/cmdline"))))
    return told


def kill(pids: list[int], number: signal.Signals = signal.SIGKILL) -> None:
    """Sends a signal to the only one of them."""
    (pid,) = pids
    os.kill(pid, number)


def shared_memory() -> set[str]:
    """The files that Fast DDS has in shared memory."""
    return {file.name for file in Path("/dev/shm").glob("*fastdds_*")}
