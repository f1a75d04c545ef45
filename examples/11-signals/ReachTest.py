"""Does the joint reach its goal? Only the end of the motion is checked."""

from __future__ import annotations

import socket

import rtf

TOLERANCE = 0.01
"""In radians."""


class ReachTest(rtf.TestCase):
    """Moves the joint, and checks where it ends."""

    def setup(self, args: list[str]) -> None:
        port, goal = args
        self.goal = float(goal)
        self.connection = socket.create_connection(("127.0.0.1", int(port)))
        self.arm = self.connection.makefile("rw")

    def run(self) -> None:
        self.command(f"move {self.goal}")
        self.sleep(1.0)
        self.check_near(self.position(), self.goal, TOLERANCE, "position")

    def tearDown(self) -> None:
        if hasattr(self, "arm"):
            self.command("move 0")
            self.wait_until(lambda: abs(self.position()) < TOLERANCE, 5, "the joint at rest")
            self.connection.close()

    def position(self) -> float:
        """The position of the joint, in radians."""
        return float(self.command("state").split()[1])

    def command(self, line: str) -> str:
        """Sends a command and returns the answer."""
        self.arm.write(line + "\n")
        self.arm.flush()
        return self.arm.readline()
