"""Texts and names from pytest's reports."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pytest

# The first line of a text from a worker of pytest-xdist: `[gw0] linux -- Python 3.11.7 …`.
_WORKER = re.compile(r"\[\w+\] \S+ -- Python ")

_REASON_CHARACTERS = 400


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


def long_text(report: pytest.TestReport | pytest.CollectReport) -> str:
    """Return the whole text of a report, without the line that names a worker."""
    text = report.longreprtext
    first, _, rest = text.partition("\n")
    is_of_worker = hasattr(report, "node") and _WORKER.match(first)
    return rest.strip() if is_of_worker else text


def collection_problem(report: pytest.CollectReport) -> tuple[str, str]:
    """Return the short and the long text of a collection error."""
    long = long_text(report)
    marked = [line[1:].strip() for line in long.splitlines() if line.startswith("E ")]
    last = marked[-1] if marked else _first_sentence(long)
    return f"{report.nodeid or 'the files'} cannot be collected: {last}", long


def _first_sentence(text: str) -> str:
    """Return the beginning of a text without a traceback: its last lines are hints."""
    lines = [line.strip() for line in text.splitlines()]
    hints = (at for at, line in enumerate(lines) if line.lower().startswith("hint:"))
    whole = " ".join(filter(None, lines[: next(hints, len(lines))]))
    return shortened(whole) or "unknown error"


def shortened(text: str) -> str:
    """Return the start of a text that is too long for a reason."""
    return text if len(text) <= _REASON_CHARACTERS else text[: _REASON_CHARACTERS - 1] + "…"
