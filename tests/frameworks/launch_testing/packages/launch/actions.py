"""The actions of a launch."""

from __future__ import annotations

import asyncio
import itertools
import signal
import subprocess
from collections.abc import Coroutine
from pathlib import Path
from typing import Any

from .event_handlers import ProcessExited, ProcessOutput, ProcessStarted

_NUMBERS = itertools.count(1)

# A process that is stopped gets these signals, one after the other, after so many seconds.
_STOP_SIGNALS = [(0, signal.SIGINT), (5, signal.SIGTERM), (5, signal.SIGKILL)]


def _start(context: Any, work: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
    task = asyncio.get_running_loop().create_task(work)
    context.tasks.add(task)
    return task


class DeclareLaunchArgument:
    """An argument of a launch."""

    def __init__(self, name: str, default_value: str | None = None) -> None:
        self._name, self._default_value = name, default_value

    def execute(self, context: Any) -> None:
        """Sets the default value."""
        if self._default_value is not None:
            context.launch_configurations.setdefault(self._name, self._default_value)
        elif self._name not in context.launch_configurations:
            raise RuntimeError(f"Required launch argument '{self._name}' was not provided")


class RegisterEventHandler:
    """Registers a handler of events."""

    def __init__(self, handler: Any) -> None:
        self._handler = handler

    def execute(self, context: Any) -> None:
        """Registers it: the newest one is called first, as by the real launch."""
        context.handlers.insert(0, self._handler)


class Shutdown:
    """Stops the launch."""

    def __init__(self, *, reason: str = "") -> None:
        self._reason = reason

    def execute(self, context: Any) -> None:
        """Stops all processes."""
        print(f"[INFO] [launch]: shutdown: {self._reason}", flush=True)
        context.shut_down()


class TimerAction:
    """Executes actions later."""

    def __init__(self, *, period: float, actions: list[Any]) -> None:
        self._period, self.entities = period, actions

    def execute(self, context: Any) -> None:
        """Begins to wait."""

        async def wait() -> None:
            await asyncio.sleep(self._period)
            for action in self.entities:
                context.execute(action)

        task = _start(context, wait())
        context.on_shutdown.append(task.cancel)


class ExecuteProcess:
    """Starts a process."""

    def __init__(self, *, cmd: list[Any], shell: bool = False, output: str = "log") -> None:
        self.cmd, self._shell, self._output = cmd, shell, output
        self.process_details: dict[str, Any] = {}

    def execute(self, context: Any) -> None:
        """Starts it."""
        _start(context, self._run(context))

    async def _run(self, context: Any) -> None:
        words = [context.text(word) for word in self.cmd]
        name = f"{Path(words[0].split()[0]).name}-{next(_NUMBERS)}"
        self.process_details["name"] = name
        process = subprocess.Popen(
            " ".join(words) if self._shell else words,
            shell=self._shell,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        stopping = [None]
        context.on_shutdown.append(
            lambda: stopping.insert(0, asyncio.ensure_future(self._stop(process)))
        )
        context.emit(ProcessStarted(self, name))
        streams = ((process.stdout, True), (process.stderr, False))
        reading = [
            asyncio.ensure_future(self._read(context, name, stream, is_stdout))
            for stream, is_stdout in streams
        ]
        if context.is_shutdown:
            process.send_signal(signal.SIGINT)
        code = await asyncio.to_thread(process.wait)
        # A child that it has left may keep them open.
        await asyncio.wait(reading, timeout=0.5)
        if stopping[0] is not None:
            stopping[0].cancel()
            await asyncio.wait(stopping[:1])
        context.emit(ProcessExited(self, name, code))

    async def _read(self, context: Any, name: str, stream: Any, is_stdout: bool) -> None:
        reader = asyncio.StreamReader()
        protocol = asyncio.StreamReaderProtocol(reader)
        await asyncio.get_running_loop().connect_read_pipe(lambda: protocol, stream)
        async for line in reader:
            if self._output == "screen":
                print(f"[{name}] {line.decode().rstrip()}", flush=True)
            context.emit(ProcessOutput(self, name, line, is_stdout))

    async def _stop(self, process: subprocess.Popen[bytes]) -> None:
        for seconds, number in _STOP_SIGNALS:
            await asyncio.sleep(seconds)
            process.send_signal(number)
