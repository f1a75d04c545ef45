"""Batches with a row for each slot: observations, actions, infos, in the forms of Gymnasium."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces

if TYPE_CHECKING:
    from numpy.typing import NDArray


def row(space: spaces.Space[Any], batch: Any, slot: int) -> Any:
    """Return the observation of a slot, from 0; `space` is that of a single observation."""
    if isinstance(space, spaces.Dict):
        return {name: row(one, batch[name], slot) for name, one in space.spaces.items()}
    if isinstance(space, spaces.Tuple):
        return tuple(row(one, part, slot) for one, part in zip(space.spaces, batch))
    return batch[slot]


def rows_with_nan(space: spaces.Space[Any], batch: Any, slots: int) -> NDArray[np.bool_]:
    """Return which observations contain a number that is NaN: an array of the shape (slots,)."""
    found = np.zeros(slots, np.bool_)
    if space.shape is not None and space.dtype is not None:
        if np.issubdtype(space.dtype, np.inexact):
            found |= np.isnan(batch).reshape(slots, -1).any(axis=1)
    elif isinstance(space, spaces.Dict):
        for name, one in space.spaces.items():
            found |= rows_with_nan(one, batch[name], slots)
    elif isinstance(space, spaces.Tuple):
        for one, part in zip(space.spaces, batch):
            found |= rows_with_nan(one, part, slots)
    return found


def shape_problem(space: spaces.Space[Any], batch: Any, name: str) -> str | None:
    """Return what is wrong with the form of actions or observations of all slots."""
    if space.shape is not None:
        got = np.shape(batch)
        if got == space.shape:
            return None
        return f"{name} of the shape {got}, expected {space.shape}: a row for each slot"
    if isinstance(space, spaces.Dict):
        keys = set(space.spaces)
        if not isinstance(batch, dict) or set(batch) != keys:
            return f"{name} that are not a dictionary with {', '.join(map(repr, sorted(keys)))}"
        parts = [(one, batch[key], f"{name}[{key!r}]") for key, one in space.spaces.items()]
    elif isinstance(space, spaces.Tuple):
        count = len(space.spaces)
        if not isinstance(batch, (tuple, list)) or len(batch) != count:
            return f"{name} that are not a tuple of {count}"
        parts = [
            (one, part, f"{name}[{index}]")
            for index, (one, part) in enumerate(zip(space.spaces, batch))
        ]
    else:
        return None
    return next((it for it in (shape_problem(*part) for part in parts) if it is not None), None)


def info_of(infos: dict[str, Any], slot: int) -> dict[str, Any]:
    """Return the `info` of the environment of a slot, from 0."""
    found: dict[str, Any] = {}
    for name, values in infos.items():
        mask = infos.get(f"_{name}")
        if name.startswith("_") and name[1:] in infos:
            continue
        if mask is not None and not mask[slot]:
            continue
        if isinstance(values, dict):
            found[name] = info_of(values, slot)
        else:
            has_rows = isinstance(values, (np.ndarray, list, tuple)) and len(values) > slot
            found[name] = values[slot] if has_rows else values
    return found
