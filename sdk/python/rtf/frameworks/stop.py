"""Stop requests: the host sends SIGTERM, and tear-down functions still have to run."""

from __future__ import annotations

import signal

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import FrameType


class Stop:
    """Raises an exception in the main thread on SIGTERM, unless the program handles it."""

    def __init__(self, exception: type[BaseException]) -> None:
        """Install the handler."""
        self.is_requested = False
        # If false, the signal is only noted.
        self.raises = True
        self._exception = exception
        if signal.getsignal(signal.SIGTERM) is signal.SIG_DFL:
            signal.signal(signal.SIGTERM, self._on_signal)

    def _on_signal(self, _number: int, _frame: FrameType | None) -> None:
        self.is_requested = True
        if self.raises:
            raise self._exception("the runner stops the test")
