"""Writes a sample that violates a monitor, and measures the time until it is asked to stop."""

from __future__ import annotations

import time
from pathlib import Path

import rtf


class Violator(rtf.TestCase):
    """Its parameter is the FIFO that the program of the signal copies."""

    def setup(self, args: list[str]) -> None:
        self.fifo = Path(args[0]).open("wb", buffering=0)  # noqa: SIM115

    def run(self) -> None:
        start = time.perf_counter()
        self.fifo.write(b"1\n")
        try:
            self.sleep(10)
        finally:
            self.latency = 1e3 * (time.perf_counter() - start)

    def tearDown(self) -> None:
        self.measure("latency", self.latency, "ms")
