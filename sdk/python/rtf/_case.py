"""A case, as a context manager."""

from __future__ import annotations

from rtf import _exceptions
from rtf._body_skip import BodySkip, BodySkipped
from rtf._stop import CriticalAssertionEnded, Interrupted, StepEnded

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import TracebackType

    from rtf._cases import OpenCase
    from rtf._session import Session

# Exceptions that end a generator or a thread, and are not a problem of the case.
_LEAVE = (GeneratorExit, SystemExit)


class Case:
    """A case, as a context manager."""

    def __init__(self, session: Session, name: str, parameters: dict[str, object]) -> None:
        """Prepare a case, which starts with the `with` statement."""
        self._session = session
        self._name = name
        self._parameters = parameters
        self._open: OpenCase | None = None
        self._body_skip: BodySkip | None = None

    def __enter__(self) -> None:
        """Start the case, or skip the body if it is not selected or the test is stopped."""
        if self._may_start():
            self._open = self._session.cases.start(self._name, self._parameters)
        else:
            self._body_skip = BodySkip()

    def _may_start(self) -> bool:
        session = self._session
        if session.phase != "run":
            session.error("cases are allowed in `run` only")
            return False
        if session.task.episodes is not None and session.cases.innermost() is None:
            session.error("a case of an episode test belongs to an episode: `with episode:`")
            return False
        is_stopped = session.request.stop.is_set()
        return not is_stopped and session.task.selects(session.cases.path_of(self._name))

    def __exit__(
        self,
        kind: type[BaseException] | None,
        problem: BaseException | None,
        trace: TracebackType | None,
    ) -> bool:
        """Finish the case, and swallow an exception that ends only the case."""
        if self._body_skip is not None:
            self._body_skip.restore_tracing()
            return isinstance(problem, BodySkipped)
        case, session = self._open, self._session
        if case is None:
            return False
        is_stopped = isinstance(problem, Interrupted) or session.request.stop.is_set()
        if is_stopped or session.cases.ends_process(problem):
            session.cases.abandon(case, is_stopped=is_stopped)
            return False
        if problem is not None and not isinstance(problem, (StepEnded, *_LEAVE)):
            _exceptions.report(session, problem)
        session.cases.finish(case)
        return problem is not None and not isinstance(problem, (CriticalAssertionEnded, *_LEAVE))
