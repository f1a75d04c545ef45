"""What one plug-in tells the runner, and what went wrong first.

The host makes a session for the plug-in it loads; the plug-in's methods write
to it from any thread. Without a host there is none, and they raise.
"""

from __future__ import annotations

import math
import os
import threading

from rtf import _location, _text
from rtf._sampling import Sampling

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Protocol

    from rtf._sampling import Notify, Signal

    class Announce(Protocol):
        """Tells the runner of a phase; held back, it comes with what is told next."""

        def __call__(self, phase: str, *, held: bool = False) -> None:
            """Tell it."""


class Judge:
    """What is known about one request of the runner: the first problem decides.

    It exists from the moment the request is read, so that a request to stop
    which comes before the plug-in was loaded is not lost.
    """

    def __init__(self) -> None:
        """Start with nothing known."""
        # Only while `run` of a test is carried out does a failure speak
        # against the robot; everywhere else it speaks against the bench.
        self.failures_are_errors = True
        self._lock = threading.Lock()
        self._first: tuple[str, str] | None = None
        self._stop = threading.Event()
        self._stop_reason = ""
        self._insists = False

    def note(self, outcome: str, reason: str) -> None:
        """Keep the first problem; later ones are told but decide nothing."""
        with self._lock:
            if self._first is None:
                self._first = (outcome, reason)

    def note_failure(self, reason: str) -> None:
        """Keep what does not hold."""
        self.note("error" if self.failures_are_errors else "failed", reason)

    def first(self) -> tuple[str, str] | None:
        """Return outcome and reason of the first problem."""
        with self._lock:
            return self._first

    def request_stop(self, reason: str) -> None:
        """Ask the plug-in to stop; this counts as a problem."""
        self.note("interrupted", reason)
        self._stop_reason = reason
        self._stop.set()

    def clear_stop(self) -> None:
        """Let a tear-down sleep and wait again, until the runner asks once more."""
        self._stop.clear()

    def stop_requested(self) -> bool:
        """Whether the plug-in is asked to stop."""
        return self._stop.is_set()

    def wait_for_stop(self, seconds: float) -> bool:
        """Wait for a request to stop, but not longer than `seconds`."""
        return self._stop.wait(seconds)

    def insist(self) -> None:
        """Announce the signal that ends a plug-in which does not look at the request."""
        self._insists = True

    def take_insistence(self) -> bool:
        """Whether a signal that came was announced; each is announced once."""
        insists, self._insists = self._insists, False
        return insists

    def stop_reason(self) -> str:
        """Return why the plug-in is asked to stop."""
        return self._stop_reason


class Task:
    """What the runner asks to be done with a plug-in."""

    def __init__(self, params: dict[str, object]) -> None:
        """Read the parameters of `run-test` or `set-up-fixture`."""
        self.file = _text_of(params, "file")
        self.name = _text_of(params, "name")
        self.param = _text_of(params, "param", "")
        self.environment = _text_of(params, "environment", "")
        args = params.get("args", [])
        repetition = params.get("repetition", 0)
        if not isinstance(args, list) or not all(isinstance(arg, str) for arg in args):
            raise TypeError("`args` is not a list of texts")
        if not isinstance(repetition, int):
            raise TypeError("`repetition` is not a whole number")
        self.args: list[str] = args
        self.repetition = repetition
        self.last = params.get("is_last", False) is True
        self.attachments_dir = _text_of(params, "attachments_dir", "")
        # What tells the test's output from the next one's, if its host may go on.
        self.shared = _text_of(params, "end_marker", "")


def _text_of(params: dict[str, object], name: str, default: str | None = None) -> str:
    value = params.get(name, default)
    if not isinstance(value, str):
        raise TypeError(f"`{name}` is missing or not a text")
    return value


class Session:
    """The link between one plug-in and the runner."""

    def __init__(self, task: Task, judge: Judge, notify: Notify, announce: Announce) -> None:
        """Serve `task`; `notify` tells the runner something, `announce` what is done now."""
        self.task = task
        self.judge = judge
        self.sampling = Sampling(notify)
        self._notify = notify
        self._announce = announce

    def notify(self, method: str, params: dict[str, object]) -> None:
        """Tell the runner something, after what was sampled before."""
        self.sampling.send()
        self._notify(method, params)

    def announce(self, phase: str, *, held: bool = False) -> None:
        """Tell the runner what is done now, after what was sampled before."""
        self.sampling.send()
        self._announce(phase, held=held)

    def message(self, kind: str, text: str, **more: object) -> None:
        """Send a message of the plug-in with the place it was written at."""
        params: dict[str, object] = {"kind": kind, "text": text}
        place = more.pop("location", None) or _location.caller()
        if isinstance(place, _location.Location):
            params["location"] = place.as_json()
        params.update((key, value) for key, value in more.items() if value)
        self.notify("message", params)

    def failure(self, text: str, **more: object) -> None:
        """Send a failure and keep it if it is the first problem."""
        self.judge.note_failure(text)
        self.message("failure", text, **more)

    def measured(
        self, name: str, value: float, unit: str, low: float | None, high: float | None
    ) -> bool:
        """Send a measurement; one outside its limits is a problem like a failed check."""
        fields = {"name": name, "value": value, "unit": unit, "low": low, "high": high}
        params: dict[str, object] = {k: v for k, v in fields.items() if v is not None}
        place = _location.caller()
        if place is not None:
            params["location"] = place.as_json()
        good = _holds(value, low, high)
        if not good:
            self.judge.note_failure(_text.violation(name, value, unit, (low, high)))
        self.notify("measured", params)
        return good

    def sampled(self, signal: Signal, value: float, at: float | None) -> bool:
        """Keep a sample; one outside its limits is a problem like a failed check."""
        at = self.sampling.take(signal, value, at)
        name, unit, low, high = signal
        good = _holds(value, low, high)
        if not good:
            decides = self.judge.first() is None
            what = f"{name} at {_text.number(at)} s"
            self.judge.note_failure(_text.violation(what, value, unit, (low, high)))
            if decides:
                # It must not get lost.
                self.sampling.send()
        return good

    def error(self, reason: str, text: str | None = None, **more: object) -> None:
        """Send an error and keep it if it is the first problem."""
        self.judge.note("error", reason)
        self.message("error", text or reason, **more)


def _holds(value: float, low: float | None, high: float | None) -> bool:
    within = (low is None or value >= low) and (high is None or value <= high)
    return within and math.isfinite(value)


_current: Session | None = None


def _before_fork() -> None:
    """Leave a child that the plug-in forks no samples, which it would send again."""
    if _current is not None:
        _current.sampling.send()


def _after_fork_in_child() -> None:
    if _current is not None:
        _current.sampling.renew_lock()


os.register_at_fork(before=_before_fork, after_in_child=_after_fork_in_child)


def enter(session: Session | None) -> None:
    """Make `session` the one that plug-ins talk to; a process has one at a time."""
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
