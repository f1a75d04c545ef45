"""How values are written in messages: alike in all languages that have an SDK."""

from __future__ import annotations

import math


def number(value: float) -> str:
    """Write a number as C's ``%.6g`` does, so that all SDKs print the same."""
    if math.isnan(value):
        return "nan"
    return f"{value:.6g}"


def value(thing: object) -> str:
    """Write the last value of a condition that never came true."""
    if isinstance(thing, bool):
        return "true" if thing else "false"
    if isinstance(thing, float):
        return number(thing)
    return str(thing)


def violation(
    name: str, measured: float, unit: str, limits: tuple[float | None, float | None]
) -> str:
    """Write a measurement outside its limits: ``rate: 87.5 Hz is outside 95 … 105``."""
    if math.isfinite(measured):
        text = f"{name}: {exact(measured)} {unit}".rstrip()
    else:
        text = f"{name}: not a finite number"
    low, high = limits
    if low is not None and high is not None:
        return f"{text} is outside {exact(low)} … {exact(high)}"
    if low is not None:
        return f"{text} is outside ≥ {exact(low)}"
    if high is not None:
        return f"{text} is outside ≤ {exact(high)}"
    return text


def exact(value: float) -> str:
    """Write a number with all its digits: a value just outside a limit looks different from it."""
    return repr(value).removesuffix(".0")
