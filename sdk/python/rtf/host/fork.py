"""A host that starts once and forks a host for each test.

See "Forking hosts" in ``spec/protocol.md``. The server has imported what every
host imports, and no plug-in.
"""

from __future__ import annotations

import gc
import json
import os
import socket
import sys
import threading

from rtf.host.clone import Clone
from rtf.host.fork_exit import ForkExit

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

SERVER_VARIABLE = "RTF_FORK_SERVER"

_PACKET_BYTES = 65536
_DESCRIPTOR_BYTES = 4
# The place of `env_start` in /proc/PID/stat, counted from the state.
_ENV_START = 47


class InitialEnvironment:
    """The space of the server's variable, which ``/proc/PID/environ`` shows."""

    def __init__(self) -> None:
        """Find it, and check that it is writable."""
        with open("/proc/self/environ", "rb") as stream:
            environment = stream.read()
        name = f"{SERVER_VARIABLE}=".encode()
        # After a zero byte, or at the start.
        offset = (b"\0" + environment).index(b"\0" + name)
        self._length = environment.index(b"\0", offset) - offset
        with open("/proc/self/stat", "rb") as stream:
            fields = stream.read().rpartition(b") ")[2].split()
        self._start = int(fields[_ENV_START]) + offset
        self._write(environment[offset : offset + self._length])

    def write(self, variables: dict[str, str]) -> None:
        """Write variables there, as long as there is space."""
        shown = b""
        for name, value in variables.items():
            entry = os.fsencode(f"{name}={value}\0")
            if len(shown) + len(entry) <= self._length:
                shown += entry
        self._write(shown.ljust(self._length, b"\0"))

    def _write(self, data: bytes) -> None:
        memory = os.open("/proc/self/mem", os.O_WRONLY | os.O_CLOEXEC)
        try:
            os.pwrite(memory, data, self._start)
        finally:
            os.close(memory)


class Server:
    """Forks processes that become children of the runner."""

    def __init__(self) -> None:
        """Take over the socket that the runner left."""
        place = os.environ.pop(SERVER_VARIABLE).split()[0]
        self._socket = socket.socket(fileno=int(place.removeprefix("fd:")))
        self._socket.set_inheritable(False)
        self._environment = InitialEnvironment()
        self._pid_reader, self._pid_writer = os.pipe()
        self._clone = Clone.prepare(self._socket)
        self._exit = ForkExit(self._socket)
        # Forks share the memory of frozen objects, which the collector does not touch.
        gc.collect()
        gc.freeze()

    def serve(self) -> int | None:
        """Serve until the runner is gone, and return `None`; in each fork, return its channel."""
        while True:
            packet, descriptors = self._receive()
            if not packet:
                return None
            try:
                request = json.loads(packet)
                pid = self._fork(len(descriptors))
            except (OSError, RuntimeError, ValueError) as problem:
                self._answer({"error": str(problem)})
                pid = None
            if pid == 0:
                return self._become_host(request, descriptors)
            for descriptor in descriptors:
                os.close(descriptor)
            if pid is not None:
                self._answer({"pid": pid})

    def end(self, code: int) -> int:
        """End a fork, or return the exit code if the interpreter must end it."""
        return self._exit.end(code)

    def _fork(self, descriptors: int) -> int:
        """Create a child of the runner and return its id; 0 in that process."""
        if descriptors != 3:  # noqa: PLR2004 - channel, standard output, standard error
            raise ValueError(f"got {descriptors} descriptors, expected 3")
        if threading.active_count() != 1 or len(os.listdir("/proc/self/task")) != 1:
            raise RuntimeError("the interpreter has started threads")
        if self._clone is not None:
            try:
                return self._clone.fork()
            except OSError:  # no such call, or not allowed
                self._clone = None
        return self._fork_twice()

    def _fork_twice(self) -> int:
        """Fork with `os.fork`, twice.

        The process in between exits at once, so that its child becomes the child of the
        runner, which is a child subreaper.
        """
        between = os.fork()
        if between == 0:
            try:
                child = os.fork()
            except OSError:
                os._exit(1)
            if child == 0:
                return 0
            os.write(self._pid_writer, f"{child}\n".encode())
            os._exit(0)
        # After that, its child is the runner's.
        _, status = os.waitpid(between, 0)
        if status != 0:
            raise RuntimeError("cannot fork")
        return int(os.read(self._pid_reader, 64))

    def _become_host(self, request: dict[str, Any], descriptors: list[int]) -> int:
        self._socket.close()
        os.close(self._pid_reader)
        os.close(self._pid_writer)
        channel, output, errors = descriptors
        os.setpgid(0, 0)
        os.dup2(output, 1)
        os.dup2(errors, 2)
        os.close(output)
        os.close(errors)
        os.chdir(request["working_dir"])
        # `update` checks the type of its argument, which copies about fifty pages.
        for name, value in request["env"].items():
            os.environ[name] = value
        self._environment.write(request["env"])
        return channel

    def _receive(self) -> tuple[bytes, list[int]]:
        space = socket.CMSG_SPACE(3 * _DESCRIPTOR_BYTES)
        packet, control, _, _ = self._socket.recvmsg(_PACKET_BYTES, space)
        descriptors = []
        for level, kind, data in control:
            if (level, kind) == (socket.SOL_SOCKET, socket.SCM_RIGHTS):
                ends = range(0, len(data) - len(data) % _DESCRIPTOR_BYTES, _DESCRIPTOR_BYTES)
                numbers = [data[at : at + _DESCRIPTOR_BYTES] for at in ends]
                descriptors += [int.from_bytes(number, sys.byteorder) for number in numbers]
        # Python does not set close-on-exec for received descriptors.
        for descriptor in descriptors:
            os.set_inheritable(descriptor, False)  # noqa: FBT003 - the library's signature
        return packet, descriptors

    def _answer(self, reply: dict[str, object]) -> None:
        self._socket.send(json.dumps(reply).encode())
