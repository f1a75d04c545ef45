"""Asks the simulated arm."""

import socket

import rtf


class DoublesTest(rtf.TestCase):
    """The arm doubles a number."""

    def run(self) -> None:
        """Asks once."""
        port = int(self.fixture_value("arm.port"))
        with socket.create_connection(("127.0.0.1", port), 10) as arm:
            arm.sendall(b"21\n")
            self.check_near(float(arm.makefile().readline()), 42.0, 1e-9, "the answer")
