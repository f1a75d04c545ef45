"""A TCP server on loopback for many clients: one line in, one line out.

It knows nothing of robots and never blocks: `serve` returns after the given
time, so that the caller can step its physics in between.
"""

from __future__ import annotations

import selectors
import socket
from collections.abc import Callable

LONGEST_LINE = 1024
"""Bytes; a client that sends more without a line's end is not speaking this protocol."""

MOST_UNREAD = 64 * 1024
"""Bytes of answers that a client may leave unread before it is dropped."""

MOST_CLIENTS = 64


class Refused(Exception):
    """A line that cannot be carried out; its text is the client's answer."""


class Client:
    """One connection and what is still to be read and written on it."""

    def __init__(self, connection: socket.socket) -> None:
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.connection = connection
        self.received = b""
        self.unsent = b""
        self.leaving = False

    def read_lines(self) -> list[bytes] | None:
        """The complete lines that have arrived; `None` when the client has gone."""
        try:
            data = self.connection.recv(4096)
        except BlockingIOError:
            return []
        except OSError:
            return None
        if not data:
            return None
        *lines, self.received = (self.received + data).split(b"\n")
        if len(self.received) > LONGEST_LINE:
            self.say("error", f"a line has at most {LONGEST_LINE} bytes")
            self.leaving = True
        return lines

    def say(self, kind: str, text: str) -> None:
        """Queues one line for the client."""
        self.unsent += f"{kind} {text}".rstrip().encode() + b"\n"

    def flush(self) -> bool:
        """Sends what the connection takes; whether the client is to be kept."""
        try:
            while self.unsent:
                self.unsent = self.unsent[self.connection.send(self.unsent) :]
        except BlockingIOError:
            return len(self.unsent) <= MOST_UNREAD
        except OSError:
            return False
        return not self.leaving


class LineServer:
    """Answers each client's lines, in order, with what `answer` returns."""

    def __init__(self, port: int, answer: Callable[[list[str]], str]) -> None:
        self._answer = answer
        self._listener = socket.create_server(("127.0.0.1", port))
        self._listener.setblocking(False)
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._listener, selectors.EVENT_READ)

    @property
    def port(self) -> int:
        """The TCP port on which it listens."""
        port: int = self._listener.getsockname()[1]
        return port

    @property
    def clients(self) -> int:
        """How many clients are connected."""
        return len(self._selector.get_map()) - 1

    def serve(self, seconds: float) -> None:
        """Waits up to `seconds` for clients and answers those that have sent something."""
        for key, events in self._selector.select(seconds):
            if key.data is None:
                self._accept()
            else:
                self._attend(key.data, events)

    def close(self) -> None:
        """Ends all connections."""
        for key in list(self._selector.get_map().values()):
            if key.data is not None:
                self._drop(key.data)
        self._selector.close()
        self._listener.close()

    def _accept(self) -> None:
        try:
            connection, _address = self._listener.accept()
        except OSError:  # the client left before it was its turn
            return
        if self.clients >= MOST_CLIENTS:
            connection.close()
            return
        client = Client(connection)
        self._selector.register(connection, selectors.EVENT_READ, client)

    def _attend(self, client: Client, events: int) -> None:
        if events & selectors.EVENT_READ:
            lines = client.read_lines()
            if lines is None:
                self._drop(client)
                return
            for line in lines:
                self._carry_out(client, line)
        if not client.flush():
            self._drop(client)
            return
        wanted = selectors.EVENT_READ
        if client.unsent:
            wanted |= selectors.EVENT_WRITE
        self._selector.modify(client.connection, wanted, client)

    def _carry_out(self, client: Client, line: bytes) -> None:
        words = line.decode("utf-8", errors="replace").split()
        if not words or client.leaving:
            return
        if words == ["quit"]:
            client.say("ok", "")
            client.leaving = True
            return
        try:
            client.say("ok", self._answer(words))
        except Refused as refused:
            client.say("error", str(refused))

    def _drop(self, client: Client) -> None:
        self._selector.unregister(client.connection)
        client.connection.close()
