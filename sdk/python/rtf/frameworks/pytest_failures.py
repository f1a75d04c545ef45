"""Details of failures that pytest's reports do not contain."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import pytest

from rtf.frameworks.comparison import compared

if TYPE_CHECKING:
    from types import CodeType, FrameType, TracebackType

# An attribute of reports with our details. Reports of pytest-xdist's workers carry it.
DETAILS = "_rtf_details"


class FailureDetails:
    """Collects details of failures, also in the workers of pytest-xdist."""

    def __init__(self) -> None:
        """Start without a failed comparison."""
        self._comparison: FailedComparison | None = None

    def pytest_assertrepr_compare(self, op: str, left: object, right: object) -> None:
        """Keep the operands of a failed `==`, and let pytest explain it."""
        if op != "==":
            return
        frame = _frame_of_test()
        if frame is not None:
            code, line = frame
            self._comparison = FailedComparison(left, right, code, line)

    def details_of(self, item: pytest.Item, call: pytest.CallInfo[Any]) -> dict[str, object]:
        """Return the details of a problem; empty without one."""
        if call.excinfo is None:
            return {}
        details = of_failure(item, call, self._comparison)
        self._comparison = None
        return details


def _frame_of_test() -> tuple[Any, int] | None:
    """Return the innermost frame outside pytest."""
    frame: FrameType | None = sys._getframe(2)
    while frame is not None:
        module = frame.f_globals.get("__name__", "")
        if not module.startswith(("_pytest.", "pluggy.", "rtf.frameworks.")):
            return frame.f_code, frame.f_lineno
        frame = frame.f_back
    return None


class FailedComparison:
    """The operands of the `==` that failed last, and its line."""

    def __init__(self, left: object, right: object, code: CodeType, line: int) -> None:
        """Keep them until the item's report is made."""
        self._fields = _fields(left, right)
        self._code = code
        self._line = line

    def at(self, trace: TracebackType) -> dict[str, object] | None:
        """Return the comparison if a traceback ends in its line."""
        while trace.tb_next is not None:
            trace = trace.tb_next
        is_there = trace.tb_frame.f_code is self._code and trace.tb_lineno == self._line
        return self._fields if is_there else None


def _fields(left: object, right: object) -> dict[str, object] | None:
    """Compare `got == expected`; an `approx` is the expected side, wherever it is."""
    if _is_approx(left) and not _is_approx(right):
        left, right = right, left
    tolerance: object = 0.0
    if _is_approx(right):
        tolerance = getattr(right, "tolerance", None)
        right = getattr(right, "expected", None)
    return compared(left, right, tolerance)


def _is_approx(value: object) -> bool:
    return type(value).__module__ == "_pytest.python_api" or "Approx" in type(value).__name__


def of_failure(
    item: pytest.Item, call: pytest.CallInfo[Any], comparison: FailedComparison | None
) -> dict[str, object]:
    """Describe a problem: its severity, its line, and the compared numbers."""
    assert call.excinfo is not None  # noqa: S101 - the caller's condition
    problem = call.excinfo.value
    is_failure = isinstance(problem, (AssertionError, pytest.fail.Exception))
    # Of `--doctest-modules`.
    is_failure |= type(problem).__name__ in {"DocTestFailure", "MultipleDoctestFailures"}
    kind = "failure" if call.when == "call" and is_failure else "error"
    details: dict[str, object] = {"kind": kind}
    place = _line_in(str(item.path), call.excinfo.tb)
    if place is not None:
        details["location"] = place
    if comparison is not None and isinstance(problem, AssertionError):
        fields = comparison.at(call.excinfo.tb)
        if fields is not None:
            details["comparison"] = fields
    return details


def _line_in(file: str, trace: TracebackType | None) -> dict[str, object] | None:
    """Return the innermost line of a traceback in the item's file."""
    found = None
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == file:
            found = trace.tb_lineno
        trace = trace.tb_next
    return None if found is None else {"file": file, "line": found}
