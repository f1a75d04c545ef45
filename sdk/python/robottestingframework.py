"""What tests written for robot-testing-framework 2.x call.

Such a test has it without an ``import``, as it had there, but may import it,
also from other files. The functions tell the runner about the test that runs.
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
    """Tell what the test calls itself; the name that the suite gives it stays."""
    session = _session.current()
    if str(name) != session.task.name:
        session.message("report", f"test name: {name}")


def testReport(text: object) -> None:  # noqa: N802
    """Tell the user something; it does not change the verdict."""
    _session.current().message("report", str(text))


def testCheck(condition: object, text: object) -> None:  # noqa: N802
    """Check that `condition` holds, and go on either way."""
    if condition:
        _session.current().message("check", str(text))
    else:
        _session.current().failure(str(text))


def testFailIf(condition: object, text: object) -> None:  # noqa: N802
    """Fail *unless* `condition` holds, which is the predecessor's sense of it."""
    if not condition:
        _session.current().failure(str(text))


def assertFail(text: object) -> NoReturn:  # noqa: N802
    """Say that the robot is wrong, and end this step."""
    _session.current().failure(str(text))
    raise AssertionEnded(str(text))


def assertError(text: object) -> NoReturn:  # noqa: N802
    """Say that the bench is wrong, and end this step."""
    _session.current().error(str(text))
    raise AssertionEnded(str(text))


def getEnvironment() -> str:  # noqa: N802
    """Return the suite's environment string."""
    return _session.current().task.environment


# They only look like tests of pytest's.
for _function in (testReport, testCheck, testFailIf):
    _function.__dict__["__test__"] = False
