"""The functions for tests that were written for robot-testing-framework 2.x.

As there, such a test has the module without an ``import``, but may import it, also from
other files.
"""

from __future__ import annotations

from rtf import _session
from rtf._stop import AssertionEnded

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn

__all__ = [
    "assertError",
    "assertFail",
    "getEnvironment",
    "setName",
    "testCheck",
    "testFailIf",
    "testReport",
]


def setName(name: object) -> None:  # noqa: N802 - the predecessor's spelling, here and below
    """Report the test's own name; its name in the suite does not change."""
    session = _session.current()
    if str(name) != session.task.name:
        session.message("report", f"test name: {name}")


def testReport(text: object) -> None:  # noqa: N802
    """Report information; it does not change the verdict."""
    _session.current().message("report", str(text))


def testCheck(condition: object, text: object) -> None:  # noqa: N802
    """Check that `condition` holds, and continue in either case."""
    if condition:
        _session.current().message("check", str(text))
    else:
        _session.current().failure(str(text))


def testFailIf(condition: object, text: object) -> None:  # noqa: N802
    """Fail *unless* `condition` holds, which is the predecessor's sense of it."""
    if not condition:
        _session.current().failure(str(text))


def assertFail(text: object) -> NoReturn:  # noqa: N802
    """Report a failure (the robot is wrong) and end this step."""
    _session.current().failure(str(text))
    raise AssertionEnded(str(text))


def assertError(text: object) -> NoReturn:  # noqa: N802
    """Report an error (the bench is wrong) and end this step."""
    _session.current().end_with_error(str(text))


def getEnvironment() -> str:  # noqa: N802
    """Return the suite's environment string."""
    return _session.current().task.environment


# pytest must not collect them.
for _function in (testReport, testCheck, testFailIf):
    _function.__dict__["__test__"] = False
