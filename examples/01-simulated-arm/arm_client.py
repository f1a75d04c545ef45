"""Talks to the simulated arm: as a module in tests, or by hand.

python3 arm_client.py joints
python3 arm_client.py set elbow 0.5
"""

from __future__ import annotations

import os
import socket
import sys

ANSWER_SECS = 10.0
"""An arm that is slower hangs. The suite's `<alive>` notices that earlier, so
that a test does not take the blame."""


class Arm:
    """One connection to the simulator on 127.0.0.1. Any problem is an `OSError`."""

    def __init__(self, port: int | None = None) -> None:
        self.port = port or int(os.environ.get("ARM_PORT", "17681"))
        self._connection = socket.create_connection(("127.0.0.1", self.port), ANSWER_SECS)
        self._connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._lines = self._connection.makefile("r", encoding="utf-8")

    def ask(self, line: str) -> str:
        """Sends a line; what the arm answers after `ok`."""
        self._connection.sendall(f"{line}\n".encode())
        answer = self._lines.readline()
        if not answer:
            raise ConnectionError(f"the arm closed the connection at `{line}`")
        kind, _, text = answer.strip().partition(" ")
        if kind != "ok":
            raise OSError(f"`{line}`: {text}")
        return text

    def joints(self) -> list[str]:
        """The names of the joints, from the base on."""
        return self.ask("joints").split()

    def position(self, joint: str) -> float:
        """What the joint's encoder says, in radians."""
        return float(self.ask(f"get {joint}"))

    def move(self, joint: str, target: float) -> None:
        """Lets the joint begin to move to `target` radians."""
        self.ask(f"set {joint} {target}")

    def time(self) -> float:
        """Simulated seconds since the simulator's start."""
        return float(self.ask("time"))

    def close(self) -> None:
        """Ends the connection."""
        self._lines.close()
        self._connection.close()


if __name__ == "__main__":
    try:
        print(Arm().ask(" ".join(sys.argv[1:])))
    except OSError as problem:
        sys.exit(f"arm_client: {problem}")
