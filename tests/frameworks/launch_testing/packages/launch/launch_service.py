"""Runs launches in the main thread, until their processes have ended."""

from __future__ import annotations

import asyncio
import signal
import socket
from collections.abc import Callable
from typing import Any

from .launch_context import LaunchContext


class AsyncSafeSignalManager:
    """Passes signals to handlers in a loop. Handlers of Python's `signal` still run, too."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._handlers: dict[int, Callable[[int], None]] = {}
        self._reader, self._writer = socket.socketpair()

    def __enter__(self) -> AsyncSafeSignalManager:
        """Begins to receive signals."""
        self._writer.setblocking(False)
        self._loop.add_reader(self._reader, self._on_signals)
        self._previous = signal.set_wakeup_fd(self._writer.fileno())
        return self

    def __exit__(self, *_: object) -> None:
        """Ends it."""
        signal.set_wakeup_fd(self._previous)
        self._loop.remove_reader(self._reader)
        self._reader.close()
        self._writer.close()

    def handle(self, number: int, handler: Callable[[int], None]) -> None:
        """Sets the handler of a signal."""
        self._handlers[number] = handler

    def _on_signals(self) -> None:
        for number in self._reader.recv(4096):
            if number in self._handlers:
                self._handlers[number](number)


class LaunchService:
    """Runs one launch."""

    def __init__(self, *, debug: bool = False) -> None:
        self.debug = debug
        self.context = LaunchContext()
        self._description: Any = None
        self._loop = asyncio.new_event_loop()
        self._is_over = asyncio.Event()

    def include_launch_description(self, description: Any) -> None:
        """Sets what is launched."""
        self._description = description

    def run(self, *, shutdown_when_idle: bool = True) -> int:
        """Launches, and waits until all processes have ended; 1 after SIGTERM."""
        task = self._loop.create_task(self._run(shutdown_when_idle))
        while True:
            try:
                return self._loop.run_until_complete(task)
            except KeyboardInterrupt:
                continue

    def shutdown(self, *, force_sync: bool = False) -> None:
        """Stops the processes, from any thread."""
        if force_sync:
            self._shut_down()
        else:
            self._loop.call_soon_threadsafe(self._shut_down)

    def _shut_down(self) -> None:
        self.context.shut_down()
        self._is_over.set()

    async def _run(self, shutdown_when_idle: bool) -> int:
        task = asyncio.current_task()
        assert task is not None
        with AsyncSafeSignalManager(self._loop) as manager:
            manager.handle(signal.SIGINT, lambda _: self._shut_down())
            # Its processes continue to run.
            manager.handle(signal.SIGTERM, lambda _: task.cancel() and None)
            try:
                self.context.execute(self._description)
                while self.context.tasks:
                    _, self.context.tasks = await asyncio.wait(
                        self.context.tasks, return_when=asyncio.FIRST_COMPLETED
                    )
                if not shutdown_when_idle:
                    await self._is_over.wait()
            except asyncio.CancelledError:
                return 1
        return 0
