"""A host that several tests share: see "Shared hosts" in ``spec/protocol.md``."""

from __future__ import annotations

import os

from rtf.host import load

# `prctl`'s number for: orphans below this process become its children.
_SET_CHILD_SUBREAPER = 36


class SharedHost:
    """Separates the output and the processes of one test from those of the next."""

    def __init__(self, outputs: list[int]) -> None:
        """Take copies of the runner's outputs: a plug-in may redirect its own."""
        self._outputs = outputs

    @classmethod
    def begin(cls) -> SharedHost | None:
        """Prepare for several tests; `None` if this interpreter does not support it.

        Leftover processes of a test become children of this process, not of the runner.
        """
        try:
            import ctypes  # noqa: PLC0415 - not every interpreter has it

            if ctypes.CDLL(None).prctl(_SET_CHILD_SUBREAPER, 1, 0, 0, 0) != 0:
                return None
            return cls([os.dup(1), os.dup(2)])
        except (ImportError, OSError, AttributeError):
            return None

    def end_test(self, end_marker: str) -> bool:
        """Whether the next test may begin; if so, end the present test's output."""
        if _has_children():
            return False
        load.forget()
        try:
            for output in self._outputs:
                _write(output, end_marker.encode())
        except OSError:
            return False
        return True


def _has_children() -> bool:
    """Whether the test left processes behind. Reaps those that have ended."""
    try:
        while os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG) is not None:
            pass
    except ChildProcessError:
        return False
    return True


def _write(output: int, data: bytes) -> None:
    while data:
        try:
            data = data[os.write(output, data) :]
        except BlockingIOError:
            # A plug-in may have made it non-blocking. The runner reads it.
            import time  # noqa: PLC0415 - rarely needed

            time.sleep(0.001)
