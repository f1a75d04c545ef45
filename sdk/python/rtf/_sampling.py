"""Batches of samples: a test may take thousands of samples per second."""

from __future__ import annotations

import math
import threading
import time

from rtf import _location

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Callable, Union

    Notify = Callable[[str, dict[str, object]], None]
    # Name, unit, lower and upper limit.
    Signal = tuple[str, str, Union[float, None], Union[float, None]]

# A batch of this size is sent.
BATCH_SAMPLES = 256

# A batch whose oldest sample has this age is sent with the next sample.
BATCH_AGE_SECONDS = 0.1


def is_within(value: float, low: float | None, high: float | None) -> bool:
    """Whether a value is finite, and within its limits."""
    is_good = (low is None or value >= low) and (high is None or value <= high)
    return is_good and math.isfinite(value)


class Batch:
    """Samples of one signal with the same limits and in the same case."""

    __slots__ = ("case", "place", "points", "signal")

    def __init__(self, signal: Signal, case: int | None) -> None:
        """Start an empty batch at the plug-in's present line."""
        self.signal = signal
        self.case = case
        self.place = _location.caller()
        self.points: list[tuple[float, float]] = []

    def as_json(self) -> dict[str, object]:
        """Return the parameters of `sampled`."""
        name, unit, low, high = self.signal
        fields = {"low": low, "high": high, "location": self.place, "case": self.case}
        given = {key: value for key, value in fields.items() if value is not None}
        return {"name": name, "unit": unit, **given, "points": self.points}


class Sampling:
    """The samples of a test that are not sent yet."""

    def __init__(self, notify: Notify) -> None:
        """Start without samples; `notify` sends a notification to the runner."""
        self._notify = notify
        self._began: float | None = None
        self._oldest = 0.0
        self._has_failed = False
        self._batches: list[Batch] = []
        # The batch for the next samples of a signal, by its name and, in an episode test, the case.
        self._open: dict[tuple[str, int | None], Batch] = {}
        # Whether cases have separate times, as the episodes of an episode test.
        self.is_by_case = False
        self.renew_lock()

    def renew_lock(self) -> None:
        """Replace the lock in a forked child: another thread of the parent may hold it."""
        # Reentrant, because a signal handler may send a message while it is held.
        self._lock = threading.RLock()

    def begin(self) -> None:
        """Start the time of a test: its set-up begins."""
        self._began = time.monotonic()

    def add(
        self, signal: Signal, value: float, at: float | None, *, case: int | None, is_within: bool
    ) -> None:
        """Add a sample, and send the batches that are due."""
        now = time.monotonic()
        if at is None:
            at = 0.0 if self._began is None else round(now - self._began, 6)
        with self._lock:
            if not self._batches:
                self._oldest = now
            key = (signal[0], case if self.is_by_case else None)
            batch = self._open.get(key)
            if batch is None or batch.signal != signal or batch.case != case:
                batch = self._open[key] = Batch(signal, case)
                self._batches.append(batch)
            batch.points.append((at, value))
            full = len(batch.points) >= BATCH_SAMPLES or len(self._batches) >= BATCH_SAMPLES
            # The first violation may decide the verdict: a crash must not lose it.
            first_failed = not is_within and not self._has_failed
            self._has_failed |= first_failed
            if full or first_failed or now - self._oldest >= BATCH_AGE_SECONDS:
                self.send()

    def send_before(self, seconds: float) -> None:
        """Send all batches if they would become too old in this time."""
        if self._batches and time.monotonic() - self._oldest + seconds >= BATCH_AGE_SECONDS:
            self.send()

    def send(self) -> None:
        """Send all batches."""
        if self._batches:
            with self._lock:
                self._open.clear()
                while self._batches:
                    self._notify("sampled", self._batches.pop(0).as_json())
