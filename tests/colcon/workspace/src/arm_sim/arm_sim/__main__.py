"""Serves the arm on a free port, which it prints."""

import os
import socketserver
from pathlib import Path


class Arm(socketserver.StreamRequestHandler):
    """Answers with twice the number that it gets."""

    def handle(self) -> None:
        """Serves a client."""
        for line in self.rfile:
            self.wfile.write(f"{2 * float(line)}\n".encode())


if __name__ == "__main__":
    if starts := os.environ.get("ARM_STARTS"):
        with Path(starts).open("a", encoding="utf-8") as file:
            file.write(f"{os.getpid()}\n")
    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), Arm) as server:
        print(f"listening on port {server.server_address[1]}", flush=True)
        server.serve_forever()
