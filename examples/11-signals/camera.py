"""A camera: sends the number of a picture 50 times per second to each client.

camera.py PORT
"""

from __future__ import annotations

import itertools
import socketserver
import sys
import time


class Pictures(socketserver.BaseRequestHandler):
    """One client."""

    def handle(self) -> None:
        """Send pictures until the client is gone."""
        try:
            for number in itertools.count():
                self.request.sendall(f"{number}\n".encode())
                time.sleep(0.02)
        except OSError:
            pass


class Server(socketserver.ThreadingTCPServer):
    """Serves several clients."""

    allow_reuse_address = True
    daemon_threads = True


if __name__ == "__main__":
    with Server(("127.0.0.1", int(sys.argv[1])), Pictures) as server:
        print("the camera is ready", flush=True)
        server.serve_forever()
