"""Hashes of observations: equal if all types, shapes and bits are equal."""

from __future__ import annotations

from hashlib import blake2b

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

# Sixteen hexadecimal digits.
_BYTES = 8


def of(observation: Any) -> str:
    """Return the hash of bytes, a text, a number, an array, or dictionaries and lists of these."""
    state = blake2b(digest_size=_BYTES)
    for part in _parts(observation):
        # A length before each part: neighbours cannot be confused.
        state.update(b"%d:" % len(part))
        state.update(part)
    return state.hexdigest()


def _parts(thing: Any) -> list[bytes]:
    if hasattr(thing, "tobytes") and hasattr(thing, "dtype"):
        return [f"{thing.dtype.str}{thing.shape}".encode(), thing.tobytes()]
    if isinstance(thing, (bytes, bytearray, memoryview)):
        return [b"bytes", bytes(thing)]
    if thing is None or isinstance(thing, (str, int, float)):
        return [type(thing).__name__.encode(), str(thing).encode("utf-8", "surrogatepass")]
    if isinstance(thing, dict):
        pairs = sorted(thing.items())
        return [b"{", *(part for pair in pairs for one in pair for part in _parts(one)), b"}"]
    if isinstance(thing, (tuple, list)):
        return [b"[", *(part for one in thing for part in _parts(one)), b"]"]
    raise TypeError(f"an observation is bytes, a text or an array, not {type(thing).__name__}")
