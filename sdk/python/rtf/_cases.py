"""The cases of a test: named results inside it."""

from __future__ import annotations

import os
import threading
from contextvars import ContextVar

from rtf import _location

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from rtf._sampling import Notify


class OpenCase:
    """A case that has started."""

    __slots__ = ("is_open", "number", "outer", "owner", "path", "skip_reason")

    def __init__(self, owner: Cases, outer: OpenCase | None, path: str, number: int | None) -> None:
        """Open a case of a test; in a forked child, with the number of the inherited case."""
        self.owner = owner
        self.outer = outer
        self.path = path
        self.number = number
        self.is_open = True
        self.skip_reason: str | None = None

    def skip(self, reason: str) -> None:
        """Record that the case skips itself; the first reason counts."""
        if self.skip_reason is None:
            self.skip_reason = reason


# A line of the protocol has a limit.
_NAMES_IN_LINE = 4096

# The innermost case of a thread. Tasks of `asyncio` that run at the same time have
# different ones.
_innermost: ContextVar[OpenCase | None] = ContextVar("rtf_case", default=None)


class Cases:
    """The cases of a test."""

    def __init__(self, notify: Notify) -> None:
        """Start without cases, on the thread that runs the test."""
        self._notify = notify
        self._count = 0
        self._process = os.getpid()
        self._run_thread = threading.get_ident()
        self._innermost_of_run: OpenCase | None = None
        # After a stop request the runner finishes all cases that are open.
        self._is_abandoned = False
        # Reentrant, because a signal handler may open a case while it is held.
        self._lock = threading.RLock()

    def innermost(self) -> OpenCase | None:
        """Return the innermost open case of this thread."""
        case = _innermost.get()
        while case is not None and not case.is_open:
            case = case.outer
        return case if case is not None and case.owner is self else None

    def current(self) -> int | None:
        """Return the number of the case to which a message of this thread belongs."""
        if not self._count:
            return None
        case = self.innermost() or self._innermost_of_run
        return None if case is None else case.number

    def is_forked(self) -> bool:
        """Whether this is a forked child: the runner accepts no cases and values from it."""
        return os.getpid() != self._process

    def path_of(self, name: str) -> str:
        """Return the path of a case that starts now on this thread."""
        outer = self.innermost()
        return name if outer is None else f"{outer.path}/{name}"

    def plan(self, names: list[str]) -> None:
        """Announce cases."""
        if not self.is_forked():
            for first in range(0, len(names), _NAMES_IN_LINE):
                self._notify("cases-planned", {"names": names[first : first + _NAMES_IN_LINE]})

    def start(self, name: str, parameters: dict[str, object]) -> OpenCase:
        """Open a case in the innermost one of this thread."""
        outer, path = self.innermost(), self.path_of(name)
        if self.is_forked():
            case = OpenCase(self, outer, path, self.current())
        else:
            # The runner expects the numbers in order.
            with self._lock:
                self._count += 1
                case = OpenCase(self, outer, path, self._count)
                fields: dict[str, object] = {"case": case.number, "name": name}
                if outer is not None:
                    fields["parent"] = outer.number
                if parameters:
                    values = [{"name": key, "value": _text(v)} for key, v in parameters.items()]
                    fields["parameters"] = values
                _location.add_caller(fields)
                self._notify("case-started", fields)
        self._set_innermost(case)
        return case

    def finish(self, case: OpenCase) -> None:
        """Close a case and send its end."""
        self._close(case)
        if self.is_forked() or self._is_abandoned:
            return
        fields: dict[str, object] = {"case": case.number}
        if case.skip_reason is not None:
            fields.update(outcome="skipped", reason=case.skip_reason)
        self._notify("case-finished", fields)

    def abandon(self, case: OpenCase, *, is_stopped: bool) -> None:
        """Close a case that the runner finishes."""
        self._is_abandoned |= is_stopped
        self._close(case)

    def ends_process(self, problem: BaseException | None) -> bool:
        """Whether an exception ends the process; in another thread, it ends the thread."""
        return isinstance(problem, SystemExit) and threading.get_ident() == self._run_thread

    def _close(self, case: OpenCase) -> None:
        case.is_open = False
        self._set_innermost(self.innermost())

    def _set_innermost(self, case: OpenCase | None) -> None:
        _innermost.set(case)
        if threading.get_ident() == self._run_thread:
            self._innermost_of_run = case


def _text(value: object) -> str:
    """Return a parameter's value as text, as in the other languages."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return str(value)
