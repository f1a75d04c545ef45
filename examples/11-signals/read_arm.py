"""Writes the state of the arm to standard output: a line `time q dq goal` for each sample.

Usage: read_arm.py PORT
"""

from __future__ import annotations

import socket
import sys


def main() -> None:
    """Copies lines until the arm ends."""
    with socket.create_connection(("127.0.0.1", int(sys.argv[1]))) as arm:
        arm.sendall(b"watch\n")
        for line in arm.makefile():
            sys.stdout.write(line)
            sys.stdout.flush()


if __name__ == "__main__":
    main()
