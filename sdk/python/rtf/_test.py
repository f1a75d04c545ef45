"""The base class of tests."""

from __future__ import annotations

import math

from rtf import _clock, _session
from rtf._near import Comparison
from rtf._plugin import Plugin, limit_of
from rtf._stop import AssertionEnded

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable


class TestCase(Plugin):
    """A test: derive from it, and write `run`, and `setup` and `tearDown` where needed.

    The first failure or error decides the verdict. A failure means that the
    robot is wrong, an error that the bench is; a problem in `setup` or in
    `tearDown` is always an error.
    """

    __test__ = False  # pytest must not collect it

    def setup(self, args: list[str]) -> bool | None:
        """Prepare the test. `False` means that it cannot run."""

    def run(self) -> None:
        """Run the test."""
        raise NotImplementedError(f"{type(self).__name__} has no `run`")

    def tearDown(self) -> None:
        """Restore the initial state. Always called."""

    def sample(  # noqa: PLR0913, PLR0917 - the arguments of `measure`, and the time
        self,
        name: str,
        value: float,
        unit: str = "",
        low: float | None = None,
        high: float | None = None,
        time: float | None = None,
    ) -> bool:
        """Take a sample of a signal; outside its limits it is a failure, and the test continues.

        `time` is in seconds since the set-up began; the default is the current time.
        """
        signal = (name, unit, limit_of(name, low), limit_of(name, high))
        if time is not None and not math.isfinite(time):
            raise ValueError(f"the time of a sample of `{name}` is not finite")
        at = None if time is None else float(time)
        return _session.current().sampled(signal, float(value), at)

    def sample_for(  # noqa: PLR0913, PLR0917 - as in all languages
        self,
        name: str,
        seconds: float,
        rate: float,
        read: Callable[[], float],
        unit: str = "",
        low: float | None = None,
        high: float | None = None,
    ) -> bool:
        """Sample the result of `read()` at `rate` Hz; return whether all are within the limits.

        A slow `read()` skips samples.
        """
        if not rate > 0:
            raise ValueError(f"the rate of `{name}` is not above 0 Hz")
        watch, tick, good = _clock.Stopwatch(), 0, True
        while tick < seconds * rate - 1e-9:
            self.sleep(max(0.0, tick / rate - watch.passed()))
            good = self.sample(name, read(), unit, low, high) and good
            # Each tick has a separate deadline, so that delays do not accumulate.
            tick = max(tick + 1, math.ceil(watch.passed() * rate))
        self.sleep(max(0.0, seconds - watch.passed()))
        return good

    def check(self, condition: object, text: object) -> bool:
        """Check that `condition` holds, and continue in either case."""
        if condition:
            _session.current().message("check", str(text))
            return True
        _session.current().failure(str(text))
        return False

    def require_critical(self, condition: object, text: object) -> None:
        """Assert that it is safe to continue: if not, the rest of the suite is skipped."""
        if not condition:
            _session.current().failure(str(text), critical=True)
            raise AssertionEnded(str(text))
        _session.current().message("check", str(text))

    def check_near(self, got: Any, expected: Any, tolerance: float, what: object) -> bool:
        """Check that two numbers, vectors or arrays differ by at most `tolerance` anywhere."""
        return _send(Comparison(got, expected, tolerance, angle=False), str(what))

    def require_near(self, got: Any, expected: Any, tolerance: float, what: object) -> None:
        """Assert what `check_near` checks."""
        if not self.check_near(got, expected, tolerance, what):
            raise AssertionEnded(str(what))

    def check_angle_near(self, got: Any, expected: Any, tolerance: float, what: object) -> bool:
        """Check angles in radians: 3.1 and -3.1 are 0.083 apart."""
        return _send(Comparison(got, expected, tolerance, angle=True), str(what))

    def require_angle_near(self, got: Any, expected: Any, tolerance: float, what: object) -> None:
        """Assert what `check_angle_near` checks."""
        if not self.check_angle_near(got, expected, tolerance, what):
            raise AssertionEnded(str(what))


def _send(comparison: Comparison, what: str) -> bool:
    session = _session.current()
    problem = comparison.problem()
    if problem is None:
        session.message("check", what, comparison=comparison.as_json())
        return True
    session.failure(f"{what}: {problem}", comparison=comparison.as_json())
    return False
