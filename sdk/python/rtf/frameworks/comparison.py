"""Numbers that an assertion compared, for reports."""

from __future__ import annotations

import numbers

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

# The longest sequences that are compared number by number.
_NUMBERS = 200


def compared(got: object, expected: object, tolerance: Any) -> dict[str, object] | None:
    """Return the `comparison` of a message; `None` if these are not numbers.

    Two sequences of numbers have the same length, and one tolerance.
    """
    got_numbers, expected_numbers = _as_numbers(got), _as_numbers(expected)
    if got_numbers is None or expected_numbers is None:
        return None
    if len(got_numbers) != len(expected_numbers):
        return None
    if not is_number(tolerance):
        return None
    return {"expected": expected_numbers, "got": got_numbers, "tolerance": float(tolerance)}


def is_number(value: object) -> bool:
    """Whether this is a real number, and not a truth value."""
    return isinstance(value, numbers.Real) and not isinstance(value, bool)


def _as_numbers(value: Any) -> list[float] | None:
    entries = value if isinstance(value, (list, tuple)) else [value]
    if 0 < len(entries) <= _NUMBERS and all(map(is_number, entries)):
        return [float(entry) for entry in entries]
    return None
