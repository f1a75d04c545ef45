"""The channel to the runner: JSON-RPC 2.0, one message a line."""

from __future__ import annotations

import json
import math
import os
import sys
import threading
import time

CHANNEL_VARIABLE = "RTF_CHANNEL"

_READ_BYTES = 65536

# The longest line that the runner accepts, its end included.
LINE_LIMIT = 16 * 1024 * 1024

# Results that are held at least so long are sent with the next one.
_HELD_SECONDS = 0.05

_PHASE = b'{"jsonrpc": "2.0", "method": "phase", "params": {"phase": "%s"}}\n'

# `json.dumps` would create one for each line.
_ENCODER = json.JSONEncoder(ensure_ascii=False, allow_nan=False)


class Channel:
    """Reads and writes lines; any thread may write."""

    def __init__(self, descriptor: int) -> None:
        """Take over the descriptor, and close it in the plug-in's children."""
        self.descriptor = descriptor
        self._rest = b""
        # Lines that are sent with the next one.
        self._held = b""
        self._held_since = 0.0
        os.set_inheritable(descriptor, False)  # noqa: FBT003 - the library's signature
        self._renew_lock()
        # A forked child must neither wait for a lock that another thread held, nor send the held
        # lines again.
        os.register_at_fork(before=self.flush, after_in_child=self._renew_lock)

    @classmethod
    def from_environment(cls) -> Channel:
        """Open the channel that the runner named, and remove the variable."""
        place = os.environ.pop(CHANNEL_VARIABLE, "")
        scheme, _, number = place.partition(":")
        if scheme != "fd" or not number.isdecimal():
            raise ValueError(f"{CHANNEL_VARIABLE} is `{place}`, expected `fd:N`")
        return cls(int(number))

    def _renew_lock(self) -> None:
        self._lock = threading.Lock()

    def receive(self) -> list[bytes] | None:
        """Wait for lines and return them; `None` when the runner is gone."""
        try:
            data = os.read(self.descriptor, _READ_BYTES)
        except ConnectionResetError:
            return None
        if not data:
            return None
        *whole, self._rest = (self._rest + data).split(b"\n")
        return whole

    def announce(self, phase: str, *, held: bool = False) -> None:
        """Announce a phase; `held` if no code of the plug-in runs in it."""
        self._write(_PHASE % phase.encode(), held=held)

    def send(self, lines: bytes, *, held: bool = False) -> None:
        """Send encoded lines in one write; `held` if others follow within moments."""
        if held and not self._held:
            self._held_since = time.monotonic()
        elif held and time.monotonic() - self._held_since > _HELD_SECONDS:
            held = False
        self._write(lines, held=held)

    def notify(self, method: str, params: dict[str, object]) -> None:
        """Send a notification. A text that is too long for a line is sent in parts."""
        data = encode({"jsonrpc": "2.0", "method": method, "params": params})
        text = params.get("text")
        if len(data) <= LINE_LIMIT or not isinstance(text, str):
            self._write(data)
            return
        middle = len(text) // 2
        for part in (text[:middle], text[middle:]):
            self.notify(method, {**params, "text": part})

    def answer(self, number: object, result: dict[str, object], *, held: bool = False) -> None:
        """Answer a request; `held` if the next one begins immediately."""
        self._write(encode({"jsonrpc": "2.0", "id": number, "result": result}), held=held)

    def refuse(self, number: object, code: int, text: str) -> None:
        """Refuse a request."""
        error = {"code": code, "message": text}
        self._write(encode({"jsonrpc": "2.0", "id": number, "error": error}))

    def flush(self) -> None:
        """Send held lines."""
        if self._held:
            self._write(b"")

    def _write(self, data: bytes, *, held: bool = False) -> None:
        try:
            with self._lock:
                data, self._held = self._held + data, b""
                if held:
                    self._held = data
                    return
                while data:
                    data = data[os.write(self.descriptor, data) :]
        except (BrokenPipeError, ConnectionResetError):
            end_without_runner()


def encode(line: dict[str, object]) -> bytes:
    """Encode one line."""
    return encoded(line, _ENCODER) + b"\n"


def encoded(value: object, encoder: json.JSONEncoder) -> bytes:
    """Encode a value. Non-finite numbers become ``null``."""
    try:
        text = encoder.encode(value)
    except ValueError:
        text = encoder.encode(_finite(value))
    # A file name that is not UTF-8 holds lone surrogates, which JSON cannot carry.
    return text.encode("utf-8", "replace")


def _finite(value: object) -> object:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(entry) for entry in value]
    return value


def end_without_runner() -> None:
    """End the process immediately: the runner is gone."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):  # its reader is gone, too
            continue
    os._exit(1)
