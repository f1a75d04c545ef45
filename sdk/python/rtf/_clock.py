"""The time for a plug-in: the simulator's, if its suite has a clock."""

from __future__ import annotations

import os
import time

# Names a file with the simulated time in seconds.
_VARIABLE = "RTF_CLOCK"


def is_simulated() -> bool:
    """Whether the time is a simulator's."""
    return bool(os.environ.get(_VARIABLE))


def _read() -> float | None:
    path = os.environ.get(_VARIABLE)
    if not path:
        return time.monotonic()
    try:
        with open(path, encoding="ascii", errors="replace") as file:
            text = file.read()
        # Without a line end, it is still being written.
        return float(text) if text.endswith("\n") else None
    except (OSError, ValueError):
        return None


class _Latest:
    """The last time, for when the file is being written."""

    seconds = 0.0


def now() -> float:
    """Seconds since an arbitrary time."""
    seconds = _read()
    if seconds is not None:
        _Latest.seconds = seconds
    return _Latest.seconds


class Stopwatch:
    """Measures the elapsed time, without jumps back."""

    def __init__(self) -> None:
        self._before = _read()
        self._passed = 0.0

    def passed(self) -> float:
        """Seconds since the stopwatch was created."""
        seconds = _read()
        if seconds is not None:
            if self._before is not None:
                self._passed += max(0.0, seconds - self._before)
            self._before = seconds
        return self._passed
