"""Details of items that pytest's reports do not contain."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pytest

# Marks that control pytest itself.
_NO_TAGS = frozenset(
    {"parametrize", "usefixtures", "filterwarnings", "skip", "skipif", "xfail", "tryfirst"}
)

_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")

# The longest value of a parameter.
_VALUE_CHARACTERS = 200


def start(item: pytest.Item, root: str) -> dict[str, object]:
    """Return what is known about an item before it runs."""
    params: dict[str, object] = {"name": item.nodeid}
    path, line, _ = item.location
    if line is not None:
        params["location"] = {"file": f"{root}/{path}", "line": line + 1}
    tags = {mark.name for mark in item.iter_markers()} - _NO_TAGS
    if tags:
        params["tags"] = sorted(tags)
    callspec = getattr(item, "callspec", None)
    if callspec is not None and callspec.params:
        values = callspec.params.items()
        params["parameters"] = [{"name": name, "value": as_text(value)} for name, value in values]
    return params


def as_text(value: object) -> str:
    """Return the value of a parameter as text, which is the same in each run."""
    if isinstance(value, (str, int, float, bool)) or value is None:
        text = str(value)
    elif isinstance(value, type) or callable(value):
        text = getattr(value, "__qualname__", None) or type(value).__qualname__
    else:
        try:
            text = repr(value)
        except Exception as problem:  # noqa: BLE001 - any exception of the user
            text = f"<{type(value).__qualname__}: {problem!r}>"
    text = _ADDRESS.sub("", text)
    return text if len(text) <= _VALUE_CHARACTERS else text[: _VALUE_CHARACTERS - 1] + "…"
