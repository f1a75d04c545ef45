"""Samples of signals, which are sent in batches: a test may take thousands in a second."""

from __future__ import annotations

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

# A batch is sent when it has so many samples.
COUNT = 256

# A sample waits no longer for the next ones. Who takes no more and does something
# else for long is behind by the last batch.
AGE_SECONDS = 0.1


class Batch:
    """Samples of one signal under the same limits."""

    __slots__ = ("place", "points", "signal")

    def __init__(self, signal: Signal) -> None:
        """Start without any, where the plug-in takes the first one."""
        self.signal = signal
        self.place = _location.caller()
        self.points: list[tuple[float, float]] = []

    def as_json(self) -> dict[str, object]:
        """Return the form that the protocol gives it."""
        name, unit, low, high = self.signal
        place = self.place.as_json() if self.place is not None else None
        fields = {"low": low, "high": high, "location": place}
        given = {key: value for key, value in fields.items() if value is not None}
        return {"name": name, "unit": unit, **given, "points": self.points}


class Sampling:
    """The samples of a test that were not sent yet."""

    def __init__(self, notify: Notify) -> None:
        """Start without any; `notify` tells the runner."""
        self._notify = notify
        self._began: float | None = None
        self._since = 0.0
        self._batches: list[Batch] = []
        # The batch that takes the next samples of a signal, by its name.
        self._open: dict[str, Batch] = {}
        self.renew_lock()

    def renew_lock(self) -> None:
        """Forget who held the lock: a forked child has not got that thread."""
        # A signal may come while it is held, and what handles it may tell something.
        self._lock = threading.RLock()

    def begin(self) -> None:
        """Count times from now on: the test's set-up begins."""
        self._began = time.monotonic()

    def take(self, signal: Signal, value: float, at: float | None) -> float:
        """Keep a sample, send what is due, and return the sample's time."""
        now = time.monotonic()
        if at is None:
            at = 0.0 if self._began is None else round(now - self._began, 6)
        with self._lock:
            if not self._batches:
                self._since = now
            batch = self._open.get(signal[0])
            if batch is None or batch.signal != signal:
                batch = self._open[signal[0]] = Batch(signal)
                self._batches.append(batch)
            batch.points.append((at, value))
            full = len(batch.points) >= COUNT or len(self._batches) >= COUNT
            if full or now - self._since >= AGE_SECONDS:
                self.send()
        return at

    def send_before(self, seconds: float) -> None:
        """Send all that would grow too old in this time."""
        if self._batches and time.monotonic() - self._since + seconds >= AGE_SECONDS:
            self.send()

    def send(self) -> None:
        """Send all."""
        if self._batches:
            with self._lock:
                self._open.clear()
                while self._batches:
                    self._notify("sampled", self._batches.pop(0).as_json())
