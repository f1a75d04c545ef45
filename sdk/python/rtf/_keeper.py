"""What a plug-in keeps with the result of a test: numbers and files."""

from __future__ import annotations

import math
import os

from rtf import _keep, _session
from rtf._plugin import Plugin


class Keeper(Plugin):
    """A plug-in that keeps something: a test, or a fixture in its `testFinished`."""

    def measure(
        self,
        name: str,
        value: float,
        unit: str = "",
        low: float | None = None,
        high: float | None = None,
    ) -> bool:
        """Keep a number with the result; outside its limits it is a failure.

        A value that is not a finite number lies outside any limits.
        """
        number = float(value)
        limits = [None if limit is None else float(limit) for limit in (low, high)]
        if any(limit is not None and math.isnan(limit) for limit in limits):
            raise ValueError(f"a limit of `{name}` is not a number")
        return _session.current().measured(name, number, unit, limits[0], limits[1])

    def attach(
        self,
        path: str | os.PathLike[str],
        name: str | None = None,
        media_type: str | None = None,
    ) -> None:
        """Keep a file with the result. It is copied now: write it before, to its end."""
        full = os.path.abspath(os.fspath(path))
        _keep.check(full)
        name = name or os.path.basename(full)
        session = _session.current()
        if session.task.attachments_dir:
            full = _keep.copy(full, name, session.task.attachments_dir)
        params: dict[str, object] = {"name": name, "path": full, "media_type": media_type or ""}
        session.notify("attached", params)
