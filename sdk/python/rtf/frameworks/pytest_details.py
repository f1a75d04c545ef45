"""Details of items that pytest's reports do not contain."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pytest

# Marks that control pytest itself.
_NO_TAGS = frozenset(
    {"parametrize", "usefixtures", "filterwarnings", "skip", "skipif", "xfail", "tryfirst"}
)

_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")

# The longest value of a parameter.
_VALUE_CHARACTERS = 200


class Starts:
    """What is known about items before they run."""

    def __init__(self, root: str) -> None:
        """Locations of items are relative to `root`."""
        self._root = root
        # The tags of modules and classes.
        self._tags: dict[pytest.Item | pytest.Collector | None, frozenset[str]] = {
            None: frozenset()
        }
        # The names of items whose node id is that of another item.
        self._phases: dict[pytest.Item, str] = {}

    def names(self, items: list[pytest.Item]) -> list[str]:
        """Return the names of the cases for all items, and use them from now on.

        The name of a case is the node id of its item. launch_pytest has two items with the
        same node id, `X` and `X[shutdown_test]`; the second one is the case `X [shutdown]`.
        """
        known: set[str] = set()
        for item in items:
            if item.nodeid in known:
                phase = _phase(item)
                if phase:
                    self._phases[item] = f"{item.nodeid} [{phase}]"
            known.add(item.nodeid)
        return [self.name_of(item) for item in items]

    def name_of(self, item: pytest.Item) -> str:
        """Return the name of the case for an item."""
        return self._phases.get(item, item.nodeid)

    def of(self, item: pytest.Item) -> dict[str, object]:
        """Return the parameters of `case-started`."""
        params: dict[str, object] = {"name": self.name_of(item)}
        path, line, _ = item.location
        if line is not None:
            params["location"] = {"file": f"{self._root}/{path}", "line": line + 1}
        tags = self._tags_of(item.parent)
        if item.own_markers:
            tags = tags.union(mark.name for mark in item.own_markers) - _NO_TAGS
        if tags:
            params["tags"] = sorted(tags)
        callspec = getattr(item, "callspec", None)
        if callspec is not None and callspec.params:
            values = callspec.params.items()
            params["parameters"] = [
                {"name": name, "value": as_text(value)} for name, value in values
            ]
        return params

    def _tags_of(self, node: Any) -> frozenset[str]:
        tags = self._tags.get(node)
        if tags is None:
            tags = self._tags_of(node.parent).union(mark.name for mark in node.own_markers)
            tags = self._tags[node] = tags - _NO_TAGS
        return tags


def _phase(item: pytest.Item) -> str:
    """Return what the name of an item has in addition to the end of its node id."""
    # A parameter can contain `::`, too.
    ends = (at.end() for at in re.finditer("::", item.nodeid))
    rests = (item.name.removeprefix(item.nodeid[end:]) for end in ends)
    rest = next((rest for rest in rests if rest != item.name), "")
    return rest.strip("[] ").removesuffix("_test")


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
