"""The base class of tests."""

from __future__ import annotations

import math
import os

from rtf import _keep, _session
from rtf._near import Comparison
from rtf._plugin import Plugin
from rtf._stop import AssertionEnded

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class TestCase(Plugin):
    """A test: derive from it and write `run`, and `setup` and `tearDown` where needed.

    The first failure or error decides the verdict. A failure says that the
    robot is wrong, an error that the bench is; a problem in `setup` or in
    `tearDown` is always an error.
    """

    __test__ = False  # pytest shall not collect what only looks like a test of its own

    def setup(self, args: list[str]) -> bool | None:
        """Prepare the test. `False` means that it cannot be run."""

    def run(self) -> None:
        """Do the test."""
        raise NotImplementedError(f"{type(self).__name__} has no `run`")

    def tearDown(self) -> None:
        """Put back what the test changed. Called whatever happened before."""

    def check(self, condition: object, text: object) -> bool:
        """Check that `condition` holds, and go on either way."""
        if condition:
            _session.current().message("check", str(text))
            return True
        _session.current().failure(str(text))
        return False

    def require_critical(self, condition: object, text: object) -> None:
        """Assert something without which it is unsafe to go on.

        If it does not hold this test ends, and the rest of the suite is skipped.
        """
        if not condition:
            _session.current().failure(str(text), critical=True)
            raise AssertionEnded(str(text))
        _session.current().message("check", str(text))

    def check_near(self, got: Any, expected: Any, tolerance: float, what: object) -> bool:
        """Check that two numbers, vectors or arrays differ by at most `tolerance` anywhere."""
        return _tell(Comparison(got, expected, tolerance, angle=False), str(what))

    def require_near(self, got: Any, expected: Any, tolerance: float, what: object) -> None:
        """Assert what `check_near` checks."""
        if not self.check_near(got, expected, tolerance, what):
            raise AssertionEnded(str(what))

    def check_angle_near(self, got: Any, expected: Any, tolerance: float, what: object) -> bool:
        """Check angles in radians: 3.1 and -3.1 are 0.083 apart."""
        return _tell(Comparison(got, expected, tolerance, angle=True), str(what))

    def require_angle_near(self, got: Any, expected: Any, tolerance: float, what: object) -> None:
        """Assert what `check_angle_near` checks."""
        if not self.check_angle_near(got, expected, tolerance, what):
            raise AssertionEnded(str(what))

    def measure(
        self,
        name: str,
        value: float,
        unit: str = "",
        low: float | None = None,
        high: float | None = None,
    ) -> bool:
        """Keep a number with the result; outside its limits it is a failure.

        A value that is not a finite number lies outside any limits.
        """
        number = float(value)
        limits = [None if limit is None else float(limit) for limit in (low, high)]
        if any(limit is not None and math.isnan(limit) for limit in limits):
            raise ValueError(f"a limit of `{name}` is not a number")
        return _session.current().measured(name, number, unit, limits[0], limits[1])

    def attach(
        self,
        path: str | os.PathLike[str],
        name: str | None = None,
        media_type: str | None = None,
    ) -> None:
        """Keep a file with the result. It is copied now: write it before, to its end."""
        full = os.path.abspath(os.fspath(path))
        if not os.path.isfile(full):
            raise FileNotFoundError(f"there is no file `{full}` to attach")
        name = name or os.path.basename(full)
        session = _session.current()
        if session.task.keep_folder:
            full = _keep.copy(full, name, session.task.keep_folder)
        params: dict[str, object] = {"name": name, "path": full, "media_type": media_type or ""}
        session.notify("attached", params)


def _tell(comparison: Comparison, what: str) -> bool:
    session = _session.current()
    problem = comparison.problem()
    if problem is None:
        session.message("check", what, comparison=comparison.as_json())
        return True
    session.failure(f"{what}: {problem}", comparison=comparison.as_json())
    return False
