"""Stop requests: the host sends SIGTERM, and tear-down functions still have to run."""

from __future__ import annotations

import os
import signal
import threading

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import FrameType

# After it, a function that Python calls at a fork has returned.
_FORK_SECONDS = 0.05


class Stop:
    """Raises an exception in the main thread on SIGTERM, unless the program handles it.

    In a process that the program forks, the signal has its default effect, as without rtf:
    `multiprocessing` ends its workers so. Until the child has no handler, the signal is blocked:
    Python forgets a signal that arrives at the beginning of a child.
    """

    def __init__(self, exception: type[BaseException]) -> None:
        """Install the handler."""
        self.is_requested = False
        # If false, the signal is only noted.
        self.raises = True
        self._exception = exception
        # How many threads fork, and what they blocked before.
        self._forking = 0
        self._thread = threading.local()
        self._is_delayed = False
        if signal.getsignal(signal.SIGTERM) is signal.SIG_DFL:
            signal.signal(signal.SIGTERM, self._on_signal)
            os.register_at_fork(
                before=self._before_fork,
                after_in_parent=self._after_fork_in_parent,
                after_in_child=self._after_fork_in_child,
            )

    def _on_signal(self, _number: int, _frame: FrameType | None) -> None:
        self.is_requested = True
        if self._forking:
            # Python swallows an exception in a function that it calls at a fork.
            self._is_delayed = True
        elif self.raises:
            raise self._exception("the runner stops the test")

    def _before_fork(self) -> None:
        self._forking += 1
        self._thread.blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})

    def _after_fork_in_parent(self) -> None:
        signal.pthread_sigmask(signal.SIG_SETMASK, self._thread.blocked)
        self._forking -= 1
        if self._is_delayed and not self._forking:
            self._is_delayed = False
            again = threading.Timer(_FORK_SECONDS, os.kill, (os.getpid(), signal.SIGTERM))
            again.daemon = True
            again.start()

    def _after_fork_in_child(self) -> None:
        self._forking = 0
        if signal.getsignal(signal.SIGTERM) == self._on_signal:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_SETMASK, self._thread.blocked)
