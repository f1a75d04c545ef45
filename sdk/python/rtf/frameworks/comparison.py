"""Numbers that an assertion compared, for reports."""

from __future__ import annotations

import numbers

# The longest sequences that are compared number by number.
_NUMBERS = 200


def compared(got: object, expected: object, tolerance: object) -> dict[str, object] | None:
    """Return the `comparison` of a message; `None` if these are not numbers.

    Two sequences of numbers have the same length, and one tolerance.
    """
    got_numbers, expected_numbers = _as_numbers(got), _as_numbers(expected)
    if got_numbers is None or expected_numbers is None:
        return None
    if len(got_numbers) != len(expected_numbers):
        return None
    if isinstance(tolerance, bool) or not isinstance(tolerance, numbers.Real):
        return None
    return {
        "expected": expected_numbers,
        "got": got_numbers,
        "tolerance": float(tolerance),
    }


def _as_numbers(value: object) -> list[float] | None:
    if isinstance(value, bool):
        return None
    if isinstance(value, numbers.Real):
        return [float(value)]
    is_short = isinstance(value, (list, tuple)) and 0 < len(value) <= _NUMBERS
    if not is_short or not isinstance(value, (list, tuple)):
        return None
    if any(isinstance(entry, bool) or not isinstance(entry, numbers.Real) for entry in value):
        return None
    return [float(entry) for entry in value]
