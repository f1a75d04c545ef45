"""What tests and fixtures have in common."""

from __future__ import annotations

from rtf import _clock, _session, _text
from rtf._stop import AssertionEnded, Interrupted

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Callable, NoReturn

_POLL_SECONDS = 0.01


class Plugin:
    """The part of the interface that tests and fixtures share."""

    @property
    def name(self) -> str:
        """The name under which the suite knows this plug-in."""
        return _session.current().task.name

    @property
    def param(self) -> str:
        """The parameter string as it stands in the suite."""
        return _session.current().task.param

    @property
    def environment(self) -> str:
        """The suite's environment string."""
        return _session.current().task.environment

    @property
    def repetition(self) -> int:
        """The repetition that runs, from 1."""
        return _session.current().task.repetition

    def report(self, text: object) -> None:
        """Tell the user something; it does not change the verdict."""
        _session.current().message("report", str(text))

    def fail(self, text: object) -> NoReturn:
        """Say that the robot is wrong, and end this step."""
        _session.current().failure(str(text))
        raise AssertionEnded(str(text))

    def error(self, text: object) -> NoReturn:
        """Say that the bench is wrong (no network, no calibration file), and end this step."""
        _session.current().error(str(text))
        raise AssertionEnded(str(text))

    def require(self, condition: object, text: object) -> None:
        """Assert that `condition` holds; if it does not, this step ends."""
        if not condition:
            self.fail(text)
        _session.current().message("check", str(text))

    def now(self) -> float:
        """Seconds since a moment that does not matter, by the clock that the suite has."""
        return _clock.now()

    def sleep(self, seconds: float) -> None:
        """Sleep, but wake at once when the runner asks to stop; then this step ends.

        In a test of a suite with a clock these are seconds of simulated time.
        """
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
        judge = session.judge
        if judge.wait_for_stop(seconds):
            raise Interrupted(judge.stop_reason())

    def wait_until(self, condition: Callable[[], object], timeout: float, what: object) -> bool:
        """Wait until `condition()` is true, asking every 10 ms for `timeout` seconds.

        When the time is over this is a failed assertion, which tells `what`
        was waited for and the last value. The time is the one of `now`.
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
        """Whether the runner has asked to stop; a loop that runs long should look at it."""
        return _session.current().judge.stop_requested()
