"""Verifies that the first observation of each slot is that of the seed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtf._stop import Error

if TYPE_CHECKING:
    from rtf.gymnasium.slots import Slots

NAN_AT_FIRST = "the first observation contains NaN"

# How many slots an error lists.
_SLOTS_SHOWN = 8


class ResetError(Exception):
    """Something is wrong after a reset: a text, and the place if it was an exception."""


def verify(slots: Slots, seed: int) -> str | None:
    """Reset all slots with a seed, with another one, and with the first one again.

    Raises an error that names the slots that ignore the seed. Returns a remark if no observation
    depends on it.
    """
    everything = range(slots.count)
    found = []
    for one in (seed, seed + 1, seed):
        slots.reset(dict.fromkeys(everything, one))
        errors = slots.errors()
        if errors:
            raise ResetError(*errors[min(errors)])
        if slots.has_nan().any():
            raise ResetError(NAN_AT_FIRST)
        found.append(list(slots.hashes(everything).values()))
    first, other, again = found
    changed = [slot for slot in everything if first[slot] != again[slot]]
    if changed:
        text = "two resets with the same seed had different observations"
        raise Error(f"{_named(changed)} the seed: {text}")
    for one, hashes in ((seed, first), (seed + 1, other)):
        usual = max(hashes, key=hashes.count)
        different = [slot for slot in everything if hashes[slot] != usual]
        if different:
            text = f"after a reset with {one}, the observation is not that of the other slots"
            raise Error(f"{_named(different)} the seed: {text}")
    if first == other:
        return "the first observation does not depend on the seed: two seeds had the same one"
    return None


def _named(slots: list[int]) -> str:
    shown = ", ".join(map(str, slots[:_SLOTS_SHOWN])) + (", …" if slots[_SLOTS_SHOWN:] else "")
    return f"slot {shown} ignores" if len(slots) == 1 else f"the slots {shown} ignore"
