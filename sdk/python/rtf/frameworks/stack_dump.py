"""Dumps the stacks of a program that hangs, when the host sends SIGUSR2."""

from __future__ import annotations

import faulthandler
import os
import signal

STACK_VARIABLE = "RTF_STACK_FILE"


def prepare() -> None:
    """On SIGUSR2, write the stacks of all threads to the file that the host named."""
    file = os.environ.pop(STACK_VARIABLE, "")
    if file:
        # Open as long as the process, because the handler cannot open it.
        stream = open(file, "w", encoding="utf-8")  # noqa: SIM115
        faulthandler.register(signal.SIGUSR2, stream, all_threads=True)
        _open.append(stream)


_open: list[object] = []
