"""The base class of tests and fixtures."""

from __future__ import annotations

import math
import os

from rtf import _attachment, _clock, _session, _text
from rtf._stop import AssertionEnded, Interrupted

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable, NoReturn

_POLL_SECONDS = 0.01


class Plugin:
    """The functions that tests and fixtures share."""

    @property
    def name(self) -> str:
        """The plug-in's name in the suite."""
        return _session.current().task.name

    @property
    def param(self) -> str:
        """The plug-in's parameter string in the suite."""
        return _session.current().task.param

    @property
    def environment(self) -> str:
        """The suite's environment string."""
        return _session.current().task.environment

    @property
    def repetition(self) -> int:
        """The present repetition, from 1."""
        return _session.current().task.repetition

    def fixture_value(self, name: str) -> Any:
        """Return a value that a fixture provided: `simulator.port`; an unknown name is an error.

        Tests and hooks can read the values of all fixtures of their suite, a fixture those of
        the fixtures that it depends on.
        """
        session = _session.current()
        problem = f'there is no fixture value "{name}"; there are'
        return session.value_of(session.task.fixture_values, name, problem)

    def report(self, text: object) -> None:
        """Report information; it does not change the verdict."""
        _session.current().message("report", str(text))

    def fail(self, text: object) -> NoReturn:
        """Report a failure (the robot is wrong) and end this step."""
        _session.current().failure(str(text))
        raise AssertionEnded(str(text))

    def error(self, text: object) -> NoReturn:
        """Report an error (the bench is wrong: no network, no calibration) and end this step."""
        _session.current().end_with_error(str(text))

    def require(self, condition: object, text: object) -> None:
        """Assert that `condition` holds; if it does not, this step ends."""
        if not condition:
            self.fail(text)
        _session.current().message("check", str(text))

    def now(self) -> float:
        """Seconds since an arbitrary time, by the suite's clock."""
        return _clock.now()

    def sleep(self, seconds: float) -> None:
        """Sleep by the suite's clock. A stop request ends the sleep and this step."""
        if not _clock.is_simulated():
            self._pause(seconds)
            return
        _session.current().sampling.send_before(seconds)
        watch = _clock.Stopwatch()
        while (left := seconds - watch.passed()) > 0:
            self._pause(min(_POLL_SECONDS, left))
        self._pause(0)

    def _pause(self, seconds: float) -> None:
        """Sleep by the wall clock."""
        session = _session.current()
        session.sampling.send_before(seconds)
        if session.request.stop.wait(seconds):
            raise Interrupted(session.request.stop_reason)

    def wait_until(self, condition: Callable[[], object], timeout: float, what: object) -> bool:
        """Wait until `condition()` is true, polling every 10 ms for `timeout` seconds.

        After the timeout, the assertion fails with `what` and the last value. The time is
        that of `now`.
        """
        watch = _clock.Stopwatch()
        while True:
            value = condition()
            if value:
                return True
            left = timeout - watch.passed()
            if left <= 0:
                whose = " of simulated time" if _clock.is_simulated() else ""
                self.fail(
                    f"{what}: not within {_text.number(timeout)} s{whose}"
                    f" (last value: {_text.value(value)})"
                )
            self._pause(min(_POLL_SECONDS, left))

    def interrupted(self) -> bool:
        """Whether the runner has asked to stop; long loops should poll this."""
        return _session.current().request.stop.is_set()

    def measure(
        self,
        name: str,
        value: float,
        unit: str = "",
        low: float | None = None,
        high: float | None = None,
    ) -> bool:
        """Record a number; outside its limits it is a failure.

        A value that is not a finite number is outside any limits. A fixture measures in
        its `testFinished`.
        """
        number = float(value)
        limits = [limit_of(name, limit) for limit in (low, high)]
        return _session.current().measured(name, number, unit, limits[0], limits[1])

    def attach(
        self,
        path: str | os.PathLike[str],
        name: str | None = None,
        media_type: str | None = None,
    ) -> None:
        """Add a copy of a complete file to the results."""
        full = os.path.abspath(os.fspath(path))
        _attachment.check(full)
        name = name or os.path.basename(full)
        _attachment.attach(_session.current(), full, name, media_type or "")


def limit_of(name: str, limit: float | None) -> float | None:
    """Return a limit of a measurement or signal as a number."""
    if limit is None:
        return None
    if math.isnan(limit):
        raise ValueError(f"a limit of `{name}` is not a number")
    return float(limit)
