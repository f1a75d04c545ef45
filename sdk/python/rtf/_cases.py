"""The cases of a test: named results inside it."""

from __future__ import annotations

import os
import threading
from contextvars import ContextVar

from rtf import _location

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from rtf._session import Session


class OpenCase:
    """A case that has started."""

    __slots__ = ("episode", "is_open", "number", "outer", "owner", "path", "skip_reason")

    def __init__(self, owner: Cases, outer: OpenCase | None, path: str, number: int | None) -> None:
        """Open a case of a test; in a forked child, with the number of the inherited case."""
        self.owner = owner
        self.outer = outer
        self.path = path
        self.number = number
        self.is_open = True
        # The number of the episode that contains it, if any.
        self.episode: int | None = None
        self.skip_reason: str | None = None

    def skip(self, reason: str) -> None:
        """Record that the case skips itself; the first reason counts."""
        if self.skip_reason is None:
            self.skip_reason = reason


# A line of the protocol has a limit.
_NAMES_IN_LINE = 4096

_EPISODE_STARTED = (
    b'{"jsonrpc": "2.0", "method": "case-started", "params":'
    b' {"case": %d, "name": "%d", "episode": {"id": %d}}}\n'
)

# The innermost case of a thread. Tasks of `asyncio` that run at the same time have
# different ones.
_innermost: ContextVar[OpenCase | None] = ContextVar("rtf_case", default=None)


class Cases:
    """The cases of a test."""

    def __init__(self, session: Session) -> None:
        """Start without cases, on the thread that runs the test."""
        self._session = session
        self._count = 0
        self._process = os.getpid()
        self._run_thread = threading.get_ident()
        self._innermost_of_run: OpenCase | None = None
        # After a stop request the runner finishes all cases that are open.
        self._is_abandoned = False
        # How many cases are open in an episode, by its number.
        self._open_inner: dict[int, int] = {}
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
                names_in_line = names[first : first + _NAMES_IN_LINE]
                self._session.notify("cases-planned", {"names": names_in_line})

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
                    self._count_inner(case, outer)
                if parameters:
                    values = [{"name": key, "value": _text(v)} for key, v in parameters.items()]
                    fields["parameters"] = values
                _location.add_caller(fields)
                self._session.notify("case-started", fields)
        self._set_innermost(case)
        return case

    def start_episodes(self, ids: list[int]) -> int:
        """Start the cases of episodes in one write, and return the number of the first one."""
        with self._lock:
            first = self._count + 1
            self._count += len(ids)
            started = [_EPISODE_STARTED % (n, one, one) for n, one in enumerate(ids, first)]
            self._session.send(b"".join(started))
        return first

    def enter(self, number: int, name: str) -> OpenCase:
        """Make an open episode the innermost case of this thread."""
        case = OpenCase(self, self.innermost(), name, number)
        self._set_innermost(case)
        return case

    def entered(self, number: int) -> OpenCase | None:
        """Return the innermost entry of this thread into an episode."""
        case = self.innermost()
        while case is not None and case.number != number:
            case = case.outer
        return case

    def resume(self, case: OpenCase | None) -> None:
        """Attribute what other threads report to a case that this thread continues."""
        self._innermost_of_run = case

    def finish_episode(self, number: int, fields: bytes, *, held: bool) -> None:
        """Send the end of an episode; `fields` are encoded, each with a comma before it."""
        is_stopped = self._is_abandoned or self._session.request.stop.is_set()
        if not is_stopped and not self.is_forked():
            line = b'{"jsonrpc": "2.0", "method": "case-finished", "params": {"case": %d%b}}\n'
            self._session.send(line % (number, fields), held=held)

    def has_open_inner(self, number: int) -> bool:
        """Whether a case in an episode is open, on any thread."""
        return bool(self._open_inner.get(number))

    def finish(self, case: OpenCase) -> None:
        """Close a case and send its end."""
        self.leave(case)
        if self.is_forked() or self._is_abandoned:
            return
        fields: dict[str, object] = {"case": case.number}
        if case.skip_reason is not None:
            fields.update(outcome="skipped", reason=case.skip_reason)
        self._session.notify("case-finished", fields)

    def abandon(self, case: OpenCase, *, is_stopped: bool) -> None:
        """Close a case that the runner finishes."""
        self._is_abandoned |= is_stopped
        self.leave(case)

    def ends_process(self, problem: BaseException | None) -> bool:
        """Whether an exception ends the process; in another thread, it ends the thread."""
        return isinstance(problem, SystemExit) and threading.get_ident() == self._run_thread

    def _count_inner(self, case: OpenCase, outer: OpenCase) -> None:
        if self._session.task.episodes is not None and outer.number is not None:
            case.episode = outer.episode or outer.number
            self._open_inner[case.episode] = self._open_inner.get(case.episode, 0) + 1

    def leave(self, case: OpenCase) -> None:
        """Make the case around this one the innermost case of this thread."""
        case.is_open = False
        if case.episode is not None:
            with self._lock:
                self._open_inner[case.episode] -= 1
                if not self._open_inner[case.episode]:
                    del self._open_inner[case.episode]
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
