"""The session of one plug-in with the runner.

The host creates a session for each plug-in that it loads; the plug-in's methods use it
from any thread. Without a host there is no session, and they raise an error.
"""

from __future__ import annotations

import os
import threading
from queue import SimpleQueue

from rtf import _location
from rtf._cases import Cases
from rtf._sampling import Sampling, is_within
from rtf._stop import AssertionEnded

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn, Protocol, TypeVar

    from rtf._episodes import Episodes
    from rtf._sampling import Signal
    from rtf._task import Task

    class Channel(Protocol):
        """Sends lines to the runner."""

        def announce(self, phase: str, *, held: bool = False) -> None:
            """Announce a phase; `held` delays it until the next line."""

        def notify(self, method: str, params: dict[str, object]) -> None:
            """Send a notification."""

        def send(self, lines: bytes, *, held: bool = False) -> None:
            """Send encoded lines in one write; `held` delays them until the next line."""

        def flush(self) -> None:
            """Send held lines."""

    _Value = TypeVar("_Value")
    # An answer, or `None` and the problem.
    QuestionEnd = tuple[str | None, str]


class RequestState:
    """The state of one request of the runner.

    It exists from the moment the request is read, so that a stop request that arrives
    before the plug-in is loaded is not lost.
    """

    def __init__(self) -> None:
        """Start without a problem and without a stop request."""
        # The outcome of the first problem, and its reason if no message reports it.
        self._first: tuple[str, str | None] | None = None
        self._skip_reason: str | None = None
        # Whether, and why, the plug-in is asked to stop.
        self.stop = threading.Event()
        self.stop_reason = ""
        self._is_signal_announced = False
        # The ends of questions that threads of the plug-in wait for; `None` is a stop request.
        self._questions: dict[int, SimpleQueue[QuestionEnd | None]] = {}
        # Episodes that have arrived; `None` is their end, or a stop request.
        self.episodes: SimpleQueue[list[dict[str, object]] | None] = SimpleQueue()

    def record(self, outcome: str, reason: str | None = None) -> None:
        """Record a problem; only the first one counts."""
        if self._first is None:
            self._first = (outcome, reason)

    def skip(self, reason: str) -> None:
        """Record that the test skips itself; a problem has precedence."""
        if self._skip_reason is None:
            self._skip_reason = reason

    def has_passed(self) -> bool:
        """Whether there is no problem and no skip so far."""
        return self._first is None and self._skip_reason is None

    def answer(self) -> dict[str, object]:
        """Return the answer to the request."""
        skipped = ("passed" if self._skip_reason is None else "skipped", self._skip_reason)
        outcome, reason = self._first or skipped
        return {"outcome": outcome} if reason is None else {"outcome": outcome, "reason": reason}

    def request_stop(self, reason: str) -> None:
        """Ask the plug-in to stop; this is a problem."""
        self.record("interrupted", reason)
        self.stop_reason = reason
        self.stop.set()
        for end in list(self._questions.values()):
            end.put(None)
        self.episodes.put(None)

    def open_question(self, number: int) -> None:
        """Expect the end of a question."""
        self._questions[number] = SimpleQueue()

    def close_question(self, number: int, answer: str | None, problem: str) -> None:
        """Record the answer to a question, or the problem that there is none."""
        end = self._questions.get(number)
        if end is not None:
            end.put((answer, problem))

    def wait_for_answer(self, number: int) -> QuestionEnd | None:
        """Wait for the end of a question; `None` after a stop request."""
        try:
            return None if self.stop.is_set() else self._questions[number].get()
        finally:
            del self._questions[number]

    def announce_signal(self) -> None:
        """Announce the signal that ends a plug-in that does not poll the request."""
        self._is_signal_announced = True

    def take_announced_signal(self) -> bool:
        """Whether the signal that arrived was announced; each is announced once."""
        announced, self._is_signal_announced = self._is_signal_announced, False
        return announced


class Session:
    """The connection between one plug-in and the runner."""

    def __init__(self, task: Task, request: RequestState, channel: Channel) -> None:
        """Serve `task`; `channel` sends lines to the runner."""
        self.task = task
        self.request = request
        self.sampling = Sampling(channel.notify)
        self.cases = Cases(self)
        # Those of an episode test.
        self.episodes: Episodes | None = None
        # The announced step of a test; empty in a fixture.
        self.phase = ""
        self._channel = channel

    def notify(self, method: str, params: dict[str, object]) -> None:
        """Send a notification, after the samples that were taken before."""
        self.sampling.send()
        self._channel.notify(method, params)

    def send(self, lines: bytes, *, held: bool = False) -> None:
        """Send encoded lines, after the samples that were taken before."""
        self.sampling.send()
        self._channel.send(lines, held=held)

    def flush(self) -> None:
        """Send held lines."""
        self._channel.flush()

    def notify_in_case(self, method: str, params: dict[str, object]) -> None:
        """Send a notification that belongs to the present case, if any."""
        case = self.cases.current()
        if case is not None:
            params["case"] = case
        self.notify(method, params)

    def announce(self, phase: str, *, held: bool = False) -> None:
        """Announce a phase, after the samples that were taken before."""
        self.sampling.send()
        self.phase = phase
        self._channel.announce(phase, held=held)

    def message(self, kind: str, text: str, **more: object) -> None:
        """Send a message of the plug-in with its location."""
        more["location"] = more.get("location") or _location.caller()
        params: dict[str, object] = {"kind": kind, "text": text}
        params.update((key, value) for key, value in more.items() if value)
        self.notify_in_case("message", params)

    def failure(self, text: str, **more: object) -> None:
        """Send a failure."""
        self.request.record("failed")
        self.message("failure", text, **more)

    def measured(
        self, name: str, value: float, unit: str, low: float | None, high: float | None
    ) -> bool:
        """Send a measurement, and return whether it is within its limits."""
        fields = {"name": name, "value": value, "unit": unit, "low": low, "high": high}
        params: dict[str, object] = {k: v for k, v in fields.items() if v is not None}
        _location.add_caller(params)
        self.notify_in_case("measured", params)
        return self._is_within(value, low, high)

    def sampled(self, signal: Signal, value: float, at: float | None) -> bool:
        """Add a sample, and return whether it is within its limits."""
        is_good = self._is_within(value, *signal[2:])
        self.sampling.add(signal, value, at, case=self.cases.current(), is_within=is_good)
        return is_good

    def check_trajectory(self, params: dict[str, object], band: float | None) -> None:
        """Ask the runner to compare a signal with a stored trajectory."""
        if band is not None:
            params["band"] = band
        _location.add_caller(params)
        self.notify_in_case("trajectory", params)

    def monitor(self, name: str, formula: str, severity: str) -> None:
        """Declare a formula that judges the rest of the test."""
        params: dict[str, object] = {"name": name, "formula": formula, "severity": severity}
        _location.add_caller(params)
        self.notify("monitor", params)

    def error(self, text: str, **more: object) -> None:
        """Send an error."""
        self.request.record("error")
        self.message("error", text, **more)

    def end_with_error(self, text: str) -> NoReturn:
        """Send an error, which ends the step."""
        self.error(text)
        raise AssertionEnded(text)

    def skip(self, reason: str) -> None:
        """Skip the innermost case of this thread, or without one the test."""
        case = self.cases.innermost()
        if case is not None:
            case.skip(reason)
            return
        self.require_setup_or_run("`skip` is allowed in `setup` and `run` only")
        self.request.skip(reason)

    def plan_cases(self, names: list[str]) -> None:
        """Announce those of the cases that are selected."""
        self.require_setup_or_run("cases are planned in `setup` and `run` only")
        if self.task.episodes is not None:
            self.end_with_error(
                "the cases of an episode test are its episodes, which cannot be planned"
            )
        self.cases.plan([name for name in names if self.task.selects(name)])

    def value_of(self, values: dict[str, _Value], name: str, problem: str) -> _Value:
        """Return a named value. For an unknown name, report `problem` and the known names."""
        if name not in values:
            self.end_with_error(f"{problem} {', '.join(values) or 'none'}")
        return values[name]

    def provide(self, name: str, value: object) -> None:
        """Send a value of a fixture. A forked child sends none, like a case."""
        if not self.cases.is_forked():
            self.notify("provided", {"name": name, "value": value})

    def require_setup_or_run(self, text: str) -> None:
        """Report an error in any other step."""
        if self.phase not in {"setup", "run"}:
            self.end_with_error(text)

    def _is_within(self, value: float, low: float | None, high: float | None) -> bool:
        is_good = is_within(value, low, high)
        if not is_good:
            self.request.record("failed")
        return is_good


_current: Session | None = None


def _before_fork() -> None:
    """Send all samples, so that a forked child does not send them again."""
    if _current is not None:
        _current.sampling.send()


def _after_fork_in_child() -> None:
    if _current is not None:
        _current.sampling.renew_lock()


os.register_at_fork(before=_before_fork, after_in_child=_after_fork_in_child)


def enter(session: Session | None) -> None:
    """Make `session` the present one; a process has one at a time."""
    global _current  # noqa: PLW0603 - a plug-in finds it from any thread and any constructor
    _current = session


def running() -> Session | None:
    """Return the session of the plug-in that runs, if any."""
    return _current


def current() -> Session:
    """Return the session of the plug-in that runs."""
    if _current is None:
        raise RuntimeError(
            "this works only in a plug-in that `rtf run` has started; try `rtf run FILE`"
        )
    return _current
