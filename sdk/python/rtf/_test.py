"""The base class of tests."""

from __future__ import annotations

import math
import os

from rtf import _attachment, _clock, _location, _questions, _session
from rtf._case import Case
from rtf._fault import Fault
from rtf._near import Comparison
from rtf._plugin import Plugin, limit_of
from rtf._stop import AssertionEnded, CriticalAssertionEnded, Skipped

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from typing import Any, Callable, NoReturn


# The severities of a monitor.
_SEVERITIES = ("fail", "error", "stop", "critical")


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

    def case(self, name: object, /, **parameters: object) -> Case:
        """Open a case, a named result inside the test: `with self.case("joint 3", joint=3):`.

        An assertion, an error, an exception or `skip` ends the case, and the test continues
        after it. The body does not run if the case is not selected; in a function with
        `contextlib.contextmanager`, do not `yield` in it.
        """
        return Case(_session.current(), str(name), parameters)

    def plan_cases(self, names: Iterable[object]) -> None:
        """Announce the names of cases that the test is going to run."""
        if isinstance(names, str):
            raise TypeError("`plan_cases` needs a list of names, not a text")
        _session.current().plan_cases([str(name) for name in names])

    def skip(self, reason: object) -> NoReturn:
        """End the innermost case, otherwise the test, as skipped: the bench lacks something."""
        _session.current().skip(str(reason))
        raise Skipped(str(reason))

    def ask(
        self,
        question: object,
        choices: Sequence[object] = (),
        timeout: float = _questions.ANSWER_SECONDS,
        default: object | None = None,
        picture: str | os.PathLike[str] | None = None,
    ) -> str:
        """Ask an operator, on the console, the page or the API, and return the answer.

        It is one of `choices`, or without them any line of text. If no operator answers within
        `timeout` seconds, or none can, it is `default`; without a default, this is an error.
        `picture` is a PNG or JPEG file. The time limit of the test is paused meanwhile.
        """
        if isinstance(choices, str):
            raise TypeError("`ask` needs a list of choices, not a text")
        answer = None if default is None else str(default)
        path = None if picture is None else os.fspath(picture)
        return _questions.ask(str(question), [str(it) for it in choices], timeout, answer, path)

    def instruct(
        self,
        text: object,
        picture: str | os.PathLike[str] | None = None,
        timeout: float = _questions.ANSWER_SECONDS,
        default: object | None = None,
    ) -> None:
        """Give an operator an instruction, and wait until it is done.

        The answers are `done` and `cannot`, which is an error. `default` is one of them, as
        in `ask`.
        """
        if self.ask(text, ("done", "cannot"), timeout, default, picture) != "done":
            self.error(f"the operator cannot do this: {text}")

    def fault(self, name: str) -> Fault:
        """Inject a fault of the suite, and return when it has begun.

        It ends with the test at the latest; `remove()` of the result, or the end of a `with`
        block, removes it earlier.
        """
        return Fault(name)

    @property
    def parameters(self) -> dict[str, str]:
        """The test's values of a matrix."""
        return dict(_session.current().task.parameters)

    def parameter(self, name: str) -> str:
        """Return the test's value of a matrix; an unknown name is an error."""
        session = _session.current()
        problem = f'there is no parameter "{name}"; this test has'
        return session.value_of(session.task.parameters, name, problem)

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

    def monitor(self, formula: str, name: str | None = None, severity: str = "fail") -> None:
        """Judge the rest of the test by a formula over the signals of the suite.

        `severity` is `fail`, `error`, `stop` or `critical`: what a violation means. The
        default name is the formula.
        """
        if severity not in _SEVERITIES:
            known = ", ".join(_SEVERITIES)
            raise ValueError(f"the severity of a monitor is one of {known}, not `{severity}`")
        _session.current().monitor(name or formula, formula, severity)

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

    def check_trajectory(
        self,
        name: str,
        reference: str,
        tolerance: float,
        align: str = "time",
        band: float | None = None,
    ) -> None:
        """Check that a signal, as sampled so far, stays within `tolerance` of a stored trajectory.

        `reference` is a file below the directory of the suite, which `rtf golden accept` writes.
        `align` is "time" or, for dynamic time warping by at most `band` seconds, "dtw". The runner
        compares: the test continues, and a deviation is a failure.
        """
        if align not in {"time", "dtw"}:
            raise ValueError(f'`align` is "{align}", expected "time" or "dtw"')
        _session.current().check_trajectory(
            {"name": name, "reference": reference, "tolerance": float(tolerance), "align": align},
            None if band is None else float(band),
        )

    def check_picture(
        self, name: str, picture: str | os.PathLike[str], reference: str, tolerance: float
    ) -> None:
        """Check that a picture differs by at most `tolerance` from a stored one.

        `picture` is a PNG or JPEG file, which is copied. `reference` is a file below the directory
        of the suite, which `rtf golden accept` writes. The difference is 1 minus the structural
        similarity. The runner compares: the test continues, and a difference is a failure.
        """
        full = os.path.abspath(os.fspath(picture))
        _attachment.check(full)
        check: dict[str, object] = {"reference": reference, "tolerance": float(tolerance)}
        _location.add_caller(check)
        _attachment.attach(_session.current(), full, name, "", picture=check)

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
            raise CriticalAssertionEnded(str(text))
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
