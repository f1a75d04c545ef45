"""The time that a plug-in follows: the simulator's, if its suite has a clock."""

from __future__ import annotations

import os
import time

# Set by the runner for tests of such a suite: a file with seconds.
_VARIABLE = "RTF_CLOCK"


def is_simulated() -> bool:
    """Whether the time is a simulator's."""
    return bool(os.environ.get(_VARIABLE))


def _shown() -> float | None:
    path = os.environ.get(_VARIABLE)
    if not path:
        return time.monotonic()
    try:
        with open(path, encoding="ascii", errors="replace") as file:
            text = file.read()
        # Without its end it is still being written.
        return float(text) if text.endswith("\n") else None
    except (OSError, ValueError):
        return None


class _Latest:
    """What the clock showed last, for when it shows nothing."""

    seconds = 0.0


def now() -> float:
    """Seconds of the time that is followed, since a moment that does not matter."""
    shown = _shown()
    if shown is not None:
        _Latest.seconds = shown
    return _Latest.seconds


class Stopwatch:
    """Measures how far the time goes on. What it jumps back is no time."""

    def __init__(self) -> None:
        self._before = _shown()
        self._passed = 0.0

    def passed(self) -> float:
        """Seconds since it was made."""
        shown = _shown()
        if shown is not None:
            if self._before is not None:
                self._passed += max(0.0, shown - self._before)
            self._before = shown
        return self._passed
