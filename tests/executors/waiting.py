"""Waits and compares, for the checks of executors."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

EPISODES = int(os.environ.get("RTF_TEST_EPISODES", "40"))
"""How many episodes a campaign has."""

LIMIT = 240.0 + EPISODES
"""Seconds in which each expected event must occur."""


def finish(process: subprocess.Popen[str], code: int) -> str:
    """Waits for a run; returns its standard error."""
    return finish_with_output(process, code)[1]


def finish_with_output(process: subprocess.Popen[str], code: int) -> tuple[str, str]:
    """Waits for a run; returns its standard output and standard error."""
    stdout, stderr = process.communicate(timeout=LIMIT)
    expect(process.returncode == code, f"exit code {process.returncode}\n{stdout}\n{stderr}")
    return stdout, stderr


def commands(is_wanted: Callable[[str], bool]) -> dict[int, str]:
    """The processes with such a command, by id."""
    found = {}
    for process in Path("/proc").iterdir():
        if process.name.isdigit():
            try:
                command = (process / "cmdline").read_bytes().replace(b"\0", b" ").decode()
            except OSError:
                continue
            if is_wanted(command):
                found[int(process.name)] = command
    return found


def parent(process_id: int) -> int:
    """The parent of a process."""
    status = Path(f"/proc/{process_id}/status").read_text()
    return int(status.split("PPid:")[1].split()[0])


def until(what: str, is_true: Callable[[], bool]) -> None:
    """Waits for something."""
    deadline = time.monotonic() + LIMIT
    while not is_true():
        if time.monotonic() > deadline:
            raise AssertionError(f"after {LIMIT} s: not {what}")
        time.sleep(0.05)


def equal(actual: object, expected: object) -> None:
    """Fails unless the values are equal."""
    expect(actual == expected, f"{actual} is not {expected}")


def expect(is_true: bool, message: str) -> None:
    """Fails with a message unless it is true."""
    if not is_true:
        raise AssertionError(message)
