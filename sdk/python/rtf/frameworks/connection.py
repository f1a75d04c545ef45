"""The connection of a program to the host that started it: `RTF_SESSION`.

Each packet is one JSON object. Several threads can use the connection.
"""

from __future__ import annotations

import json
import os
import socket
import sys
import threading

from rtf.host.channel import encoded, end_without_runner

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from typing import Any

SESSION_VARIABLE = "RTF_SESSION"

# The longest packet that the host accepts.
PACKET_BYTES = 65536

# The kernel's default limit for a packet is smaller.
_ANSWER_BYTES = 1 << 20

_ACCEPTED = b"0"

# A program in C++ that started this one has taken the session.
_TAKEN = "FD:"

_CLOSED = (
    f"rtf: the descriptor in {SESSION_VARIABLE} is not open here: "
    "results of this process are not reported\n"
)

_ENCODER = json.JSONEncoder(ensure_ascii=False, allow_nan=False, separators=(",", ":"))


class Rejected(Exception):  # noqa: N818 - an answer of the host, not a mistake in this package
    """The host did not accept a packet."""


class Connection:
    """Sends packets to the host."""

    def __init__(self, descriptor: int) -> None:
        """Take over the descriptor, and close it in child processes that execute a program."""
        os.set_inheritable(descriptor, False)  # noqa: FBT003 - the library's signature
        self._socket = socket.socket(fileno=descriptor)
        self._lock = threading.Lock()
        self._process = os.getpid()

    @classmethod
    def from_environment(cls) -> Connection | None:
        """Open the connection, and remove the variable. `None` without a host that listens."""
        place = os.environ.pop(SESSION_VARIABLE, "")
        if not place or place.startswith(_TAKEN):
            return None
        scheme, _, number = place.partition(":")
        if scheme != "fd" or not number.isdecimal():
            raise ValueError(f"{SESSION_VARIABLE} is `{place}`, expected `fd:N`")
        if not _is_session(int(number)):
            # A program in between has closed it, as `subprocess` does.
            sys.stderr.write(_CLOSED)
            return None
        return cls(int(number))

    def is_ours(self) -> bool:
        """Whether this process opened the connection. A forked child must not use it."""
        return os.getpid() == self._process

    def post(self, method: str, params: Mapping[str, object]) -> None:
        """Send a packet without waiting for an answer."""
        packet: dict[str, object] = {"method": method, "answer": False, "params": params}
        if self.is_ours():
            self._send(_packets(packet))

    def post_encoded(self, method: str, params: str) -> None:
        """Send a short packet without waiting for an answer. `params` is a JSON object."""
        text = f'{{"method":"{method}","answer":false,"params":{params}}}'
        if self.is_ours():
            self._send((text.encode("utf-8", "replace"),))

    def _send(self, packets: Iterable[bytes]) -> None:
        try:
            for packet in packets:
                self._socket.send(packet)
        except (BrokenPipeError, ConnectionResetError):
            end_without_runner()

    def request(self, method: str, params: Mapping[str, object]) -> None:
        """Send a packet, and wait until the host has processed it.

        A forked process does not wait: it would receive an answer of this one.
        """
        if not self.is_ours():
            self._send(_packets({"method": method, "answer": False, "params": params}))
            return
        for packet in _packets({"method": method, "params": params}):
            if self._ask(packet) != _ACCEPTED:
                raise Rejected(f"the host rejected `{method}`")

    def plan(self, names: list[str]) -> dict[str, bool]:
        """Announce cases. Returns for each name whether it runs."""
        runs: dict[str, bool] = {}
        for portion in _portions(names):
            answer = self.ask("cases-planned", {"names": portion})
            runs.update(zip(portion, (byte == ord(_ACCEPTED) for byte in answer)))
        return runs

    def ask(self, method: str, params: Mapping[str, object]) -> bytes:
        """Send a packet, and return the answer."""
        return self._ask(encoded({"method": method, "params": params}, _ENCODER))

    def _ask(self, packet: bytes) -> bytes:
        if not self.is_ours():
            raise RuntimeError("only the process that `rtf` started can report results")
        try:
            with self._lock:
                self._socket.send(packet)
                answer = self._socket.recv(_ANSWER_BYTES)
        except (BrokenPipeError, ConnectionResetError):
            end_without_runner()
            raise
        if not answer:
            end_without_runner()
        return answer


def _is_session(descriptor: int) -> bool:
    """Whether a descriptor is a socket of a host."""
    try:
        with socket.socket(fileno=os.dup(descriptor)) as copy:
            return copy.type == socket.SOCK_SEQPACKET
    except OSError:
        return False


def _portions(names: list[str]) -> Iterator[list[str]]:
    """Split names into lists that fit into a packet."""
    portion: list[str] = []
    size = 0
    for name in names:
        # Escaped, a byte has at most six bytes: `\\u0001`.
        length = 6 * len(name.encode("utf-8", "replace")) + 3
        if portion and size + length > PACKET_BYTES - 256:
            yield portion
            portion, size = [], 0
        portion.append(name)
        size += length
    if portion:
        yield portion


def encoded_text(text: str) -> str:
    """Return a text as JSON, in a tenth of the time that an object with this text takes."""
    return _ENCODER.encode(text)


def _packets(packet: dict[str, object]) -> list[bytes]:
    """Encode a packet; a text that is too long for one is sent in parts."""
    data = encoded(packet, _ENCODER)
    if len(data) <= PACKET_BYTES:
        return [data]
    params: Any = packet["params"]
    text = params.get("text")
    if not isinstance(text, str):
        return [data]
    # Between two lines, if they are not too long.
    middle = text.rfind("\n", len(text) // 4, len(text) // 2) + 1 or len(text) // 2
    parts = (
        {**packet, "params": {**params, "text": part}} for part in (text[:middle], text[middle:])
    )
    return [encoded for part in parts for encoded in _packets(part)]
