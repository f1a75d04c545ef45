"""Texts that a launch knows."""

from __future__ import annotations

from typing import Any


class LaunchConfiguration:
    """The value of a launch argument."""

    def __init__(self, name: str) -> None:
        self._name = name

    def perform(self, context: Any) -> str:
        """Returns the value."""
        return str(context.launch_configurations[self._name])
