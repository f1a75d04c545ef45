"""The episodes of a test that have arrived and not started."""

from __future__ import annotations

import threading
from collections import deque
from queue import Empty

from rtf._stop import Interrupted

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from rtf._session import RequestState


class Arrivals:
    """Episodes that have arrived; several threads may wait for them."""

    def __init__(self, request: RequestState) -> None:
        """Start without any."""
        self.episodes: deque[dict[str, Any]] = deque()
        self.have_ended = False
        """Whether no further one arrives."""
        # Reentrant, because a signal handler may take episodes while it is held.
        self.lock = threading.RLock()
        """Held while episodes are taken."""
        self._request = request
        self._waiting = 0

    def update(self) -> None:
        """Add all that have arrived. After a stop request, raise `Interrupted`."""
        try:
            while True:
                self._add(self._request.episodes.get_nowait())
        except Empty:
            pass
        if self._request.stop.is_set():
            self.wake_next()
            raise Interrupted(self._request.stop_reason)

    def announce_wait(self) -> None:
        """Announce `wait`, while the lock is held: from now on, `wake_next` wakes this thread."""
        self._waiting += 1

    def wait(self) -> None:
        """Wait until others arrive, or may have arrived."""
        arrived: list[dict[str, Any]] | None = []
        try:
            arrived = self._request.episodes.get()
        finally:
            with self.lock:
                self._waiting -= 1
                self._add(arrived)

    def wake_next(self) -> None:
        """Wake the next thread that waits, if there is anything left for it."""
        is_over = self.have_ended or self._request.stop.is_set()
        if self._waiting and (is_over or self.episodes):
            self._request.episodes.put(None if is_over else [])

    def _add(self, arrived: list[dict[str, Any]] | None) -> None:
        if arrived is not None:
            self.episodes.extend(arrived)
        elif not self._request.stop.is_set():
            self.have_ended = True
