"""Texts and names from pytest's reports."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pytest


def expected_failure(reason: str) -> str:
    """Return the reason of a case that failed as expected."""
    reason = reason.removeprefix("reason: ")
    return f"expected failure: {reason}" if reason else "expected failure"


def skip_reason(report: pytest.TestReport | pytest.CollectReport) -> str:
    """Return why an item or a module was skipped."""
    longrepr = report.longrepr
    reason = longrepr[2] if isinstance(longrepr, tuple) else str(longrepr)
    prefix = "Skipped: "
    return reason[len(prefix) :] if reason.startswith(prefix) else reason


def subtest_name(context: Any) -> str:
    """Return the name of a subtest, as pytest prints it."""
    values = ", ".join(f"{name}={value}" for name, value in context.kwargs.items())
    message = "" if context.msg is None else f"[{context.msg}]"
    return " ".join(filter(None, (message, values and f"({values})"))) or "(<subtest>)"


def collection_problem(report: pytest.CollectReport) -> tuple[str, str]:
    """Return the short and the long text of a collection error."""
    long = report.longreprtext
    marked = [line[1:].strip() for line in long.splitlines() if line.startswith("E ")]
    last = marked[-1] if marked else (long.rstrip().rpartition("\n")[2] or "unknown error")
    return f"{report.nodeid or 'the files'} cannot be collected: {last}", long
