"""A host that several tests share: see "Shared hosts" in ``spec/protocol.md``."""

from __future__ import annotations

import os
import sys

# `prctl`'s number for: orphans below this process become its children.
_SET_CHILD_SUBREAPER = 36


class Sharing:
    """What tells one test from the next."""

    def __init__(self, outputs: list[int]) -> None:
        """Keep the outputs as the runner gave them, whatever a plug-in makes of its own."""
        self._outputs = outputs

    @classmethod
    def begin(cls) -> Sharing | None:
        """Prepare for several tests; `None` when this interpreter cannot have them.

        What a test's process leaves must come here and not to the runner, so that
        it is known whose it is.
        """
        try:
            import ctypes  # noqa: PLC0415 - not every interpreter has it

            if ctypes.CDLL(None).prctl(_SET_CHILD_SUBREAPER, 1, 0, 0, 0) != 0:
                return None
            return cls([os.dup(1), os.dup(2)])
        except (ImportError, OSError, AttributeError):
            return None

    def stay(self, mark: str) -> bool:
        """End what the test has printed, if the next one may begin."""
        if _has_children():
            return False
        for name in [name for name in sys.modules if name.startswith("rtf_plugin_")]:
            # The file was run as a module; the next one may have the same name.
            del sys.modules[name]
        try:
            for output in self._outputs:
                _write(output, mark.encode())
        except OSError:
            return False
        return True


def _has_children() -> bool:
    """Whether there are processes that the test left; those that have ended are taken in."""
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
            # A plug-in may have made it non-blocking; the runner reads.
            import time  # noqa: PLC0415 - hardly ever needed

            time.sleep(0.001)
