"""Handlers of the events of processes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass
class ProcessStarted:
    """A process was started."""

    action: Any
    process_name: str


@dataclass
class ProcessOutput:
    """A process has printed a line."""

    action: Any
    process_name: str
    text: bytes
    from_stdout: bool


@dataclass
class ProcessExited:
    """A process has ended."""

    action: Any
    process_name: str
    returncode: int


class OnProcessStart:
    """Calls a function when a process starts."""

    def __init__(self, *, on_start: Callable[[Any, Any], Any]) -> None:
        self._on_start = on_start

    def __call__(self, event: object, context: Any) -> Any:
        return self._on_start(event, context) if isinstance(event, ProcessStarted) else None


class OnProcessExit:
    """Calls a function when a process ends."""

    def __init__(self, *, on_exit: Callable[[Any, Any], Any]) -> None:
        self._on_exit = on_exit

    def __call__(self, event: object, context: Any) -> Any:
        return self._on_exit(event, context) if isinstance(event, ProcessExited) else None


class OnProcessIO:
    """Calls functions when a process prints."""

    def __init__(self, *, on_stdout: Callable[[Any], Any], on_stderr: Callable[[Any], Any]) -> None:
        self._on_stdout, self._on_stderr = on_stdout, on_stderr

    def __call__(self, event: object, _: Any) -> Any:
        if not isinstance(event, ProcessOutput):
            return None
        return self._on_stdout(event) if event.from_stdout else self._on_stderr(event)
