"""A robot that follows a line with a camera, and stops if there is no picture for a while.

Writes the time, the age of the last picture in seconds, and the speed in m/s, 100 times per second.

follower.py PORT PATIENCE
"""

from __future__ import annotations

import select
import socket
import sys
import time

SPEED = 0.5
"""In m/s."""


def follow(camera: socket.socket, patience: float) -> None:
    """Drive while pictures arrive."""
    seen = time.time()
    while True:
        end = time.time() + 0.01
        while (left := end - time.time()) > 0:
            if select.select([camera], [], [], left)[0]:
                if not camera.recv(4096):
                    return
                seen = time.time()
        age = time.time() - seen
        speed = SPEED if age < patience else 0.0
        print(f"{time.time():.6f} {age:.4f} {speed}", flush=True)


if __name__ == "__main__":
    with socket.create_connection(("127.0.0.1", int(sys.argv[1]))) as connection:
        follow(connection, float(sys.argv[2]))
