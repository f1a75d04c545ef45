"""A simulated arm with one joint and a controller that is tuned a little too fast.

Usage: arm.py PORT [--damping NUMBER]

It serves connections on 127.0.0.1:PORT, with lines of text: `move GOAL` moves the joint (radians),
`state` returns one line `time q dq goal`, and `watch` returns such a line each millisecond.
Times are seconds since 1970.
"""

from __future__ import annotations

import argparse
import socketserver
import threading
import time

FREQUENCY = 16.0
"""Of the controller, in radians per second."""

STEP_SECS = 0.0005
WATCH_SECS = 0.001


class Joint:
    """The joint: its controller pulls it to the goal as a damped spring."""

    def __init__(self, damping: float) -> None:
        self.damping = damping
        self.lock = threading.Lock()
        self.time = time.time()
        self.position = self.velocity = self.goal = 0.0

    def advance(self) -> None:
        """Simulates until now."""
        now = time.time()
        while self.time + STEP_SECS <= now:
            pull = FREQUENCY**2 * (self.goal - self.position)
            brake = 2 * self.damping * FREQUENCY * self.velocity
            self.velocity += (pull - brake) * STEP_SECS
            self.position += self.velocity * STEP_SECS
            self.time += STEP_SECS

    def move(self, goal: float) -> None:
        """Sets a goal."""
        with self.lock:
            self.advance()
            self.goal = goal

    def state(self) -> str:
        """The present state, as a line."""
        with self.lock:
            self.advance()
            values = f"{self.position:.6f} {self.velocity:.5f} {self.goal:.6f}"
            return f"{self.time:.6f} {values}\n"


class Server(socketserver.ThreadingTCPServer):
    """Serves each connection in a thread."""

    allow_reuse_address = daemon_threads = True

    def __init__(self, port: int, joint: Joint) -> None:
        self.joint = joint
        super().__init__(("127.0.0.1", port), Connection)


class Connection(socketserver.StreamRequestHandler):
    """One connection."""

    server: Server

    def handle(self) -> None:
        joint = self.server.joint
        for line in self.rfile:
            match line.decode().split():
                case ["move", goal]:
                    joint.move(float(goal))
                    self.wfile.write(b"moving\n")
                case ["state"]:
                    self.wfile.write(joint.state().encode())
                case ["watch"]:
                    self.watch(joint)
                    return
                case _:
                    self.wfile.write(b"unknown command\n")

    def watch(self, joint: Joint) -> None:
        """Writes the state until the connection ends."""
        try:
            while True:
                self.wfile.write(joint.state().encode())
                time.sleep(WATCH_SECS)
        except OSError:
            pass


def main() -> None:
    """Serves until it is terminated."""
    parser = argparse.ArgumentParser()
    parser.add_argument("port", type=int)
    parser.add_argument("--damping", type=float, default=0.66)
    args = parser.parse_args()
    with Server(args.port, Joint(args.damping)) as server:
        print("the arm is ready", flush=True)
        server.serve_forever()


if __name__ == "__main__":
    main()
