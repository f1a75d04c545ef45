"""Assertions about processes."""

from __future__ import annotations

from typing import Any


def assertExitCodes(proc_info: Any, allowable_exit_codes: tuple[int, ...] = (0,)) -> None:
    """All processes have ended with one of these codes."""
    for event in proc_info:
        assert event.returncode in allowable_exit_codes, (
            f"Proc {event.process_name} exited with code {event.returncode}"
        )
