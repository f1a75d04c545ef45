"""Near equality of numbers, vectors and angles."""

from __future__ import annotations

import math

from rtf import _text

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

# Above this many numbers only the text is sent: a line of the protocol has a limit.
_MAX_NUMBERS = 100_000


class Comparison:
    """Actual and expected numbers."""

    __slots__ = ("angle", "expected", "got", "scalar", "tolerance")

    def __init__(self, got: Any, expected: Any, tolerance: float, *, angle: bool) -> None:
        """Accept numbers, (nested) sequences of numbers, or anything with ``tolist``."""
        self.scalar = _is_number(got) and _is_number(expected)
        self.got = _numbers(got)
        self.expected = _numbers(expected)
        self.tolerance = float(tolerance)
        self.angle = angle
        if not (math.isfinite(self.tolerance) and self.tolerance >= 0):
            raise ValueError(f"the tolerance {tolerance!r} is not a finite number from 0")

    def worst(self) -> int | None:
        """Return the index with the largest difference; non-finite numbers come first."""
        if len(self.got) != len(self.expected) or not self.got:
            return None
        differences = [self._difference(index) for index in range(len(self.got))]
        for index, difference in enumerate(differences):
            if not math.isfinite(difference):
                return index
        return max(range(len(differences)), key=differences.__getitem__)

    def problem(self) -> str | None:
        """Describe the problem; ``None`` if both are near."""
        if len(self.got) != len(self.expected):
            return f"got {len(self.got)} values, expected {len(self.expected)}"
        worst = self.worst()
        if worst is None:
            return None
        difference = self._difference(worst)
        if difference <= self.tolerance:
            return None
        got, expected = self.got[worst], self.expected[worst]
        text = (
            f"got {_text.number(got)}, expected {_text.number(expected)}"
            f" ± {_text.number(self.tolerance)}"
        )
        if math.isfinite(difference):
            text += f" (off by {_text.number(difference)})"
        return text if self.scalar else f"{text} at index {worst}"

    def as_json(self) -> dict[str, object] | None:
        """Return the protocol's `comparison`, unless it is too long for a message."""
        if len(self.got) + len(self.expected) > _MAX_NUMBERS:
            return None
        fields: dict[str, object] = {
            "expected": self.expected,
            "got": self.got,
            "tolerance": self.tolerance,
        }
        if not self.scalar and self.got and len(self.got) == len(self.expected):
            fields["worst"] = self.worst()
        return fields

    def _difference(self, index: int) -> float:
        got, expected = self.got[index], self.expected[index]
        if not (math.isfinite(got) and math.isfinite(expected)):
            return math.nan
        if self.angle:
            return abs(math.remainder(got - expected, math.tau))
        return abs(got - expected)


def _is_number(thing: Any) -> bool:
    return hasattr(thing, "__float__") and not hasattr(thing, "__len__")


def _numbers(thing: Any) -> list[float]:
    """Flatten a number, a vector or a matrix, row by row."""
    if hasattr(thing, "tolist"):
        thing = thing.tolist()
    if _is_number(thing):
        return [float(thing)]
    if isinstance(thing, (str, bytes)) or not hasattr(thing, "__iter__"):
        raise TypeError(f"{thing!r} is neither a number nor a sequence of numbers")
    return [number for element in thing for number in _numbers(element)]
