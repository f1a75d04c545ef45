"""The action that lets the tests begin."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class ReadyToTest:
    """The processes are ready."""

    def __init__(self) -> None:
        self.callbacks: list[Callable[[], None]] = []

    def execute(self, _: Any) -> None:
        """Lets the tests begin."""
        for callback in self.callbacks:
            callback()
