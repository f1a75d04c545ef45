"""Formats values in messages: the same in all SDKs (see conformance/texts.json)."""

from __future__ import annotations

import math


def number(value: float) -> str:
    """Format a number like C's ``%.6g``."""
    if math.isnan(value):
        return "nan"
    return f"{value:.6g}"


def value(thing: object) -> str:
    """Format the last value of a condition."""
    if isinstance(thing, bool):
        return "true" if thing else "false"
    if isinstance(thing, float):
        return number(thing)
    return str(thing)
