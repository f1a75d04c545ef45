"""How fast can the arm be read? Samples the shoulder while it moves to and fro."""

from __future__ import annotations

import csv
import statistics
import tempfile
import time
from pathlib import Path

import rtf
from arm_client import Arm

SWING = 0.5
"""How far the shoulder swings to each side, in radians."""


class RateTest(rtf.TestCase):
    """Measures rate and latency of the encoders, and whether simulated time is real time."""

    def setup(self, args: list[str]) -> bool:
        self.seconds = float(args[args.index("--seconds") + 1]) if "--seconds" in args else 3.0
        self.folder = tempfile.TemporaryDirectory()  # goes when this process ends
        self.arm = Arm()
        self.require("shoulder" in self.arm.joints(), "the arm has a shoulder")
        return True

    def run(self) -> None:
        self.arm.move("shoulder", SWING)
        started, simulated = time.monotonic(), self.arm.time()
        samples: list[tuple[float, float, float]] = []
        while not self.interrupted() and (now := time.monotonic() - started) < self.seconds:
            radians = self.arm.position("shoulder")
            samples.append((now, radians, time.monotonic() - started - now))
            if now > self.seconds / 2:
                self.arm.move("shoulder", -SWING)
        elapsed = time.monotonic() - started

        latencies = sorted(latency for _, _, latency in samples)
        self.measure("sampling rate", len(samples) / elapsed, "Hz", low=200)
        self.measure("median latency", 1e3 * statistics.median(latencies), "ms", high=5)
        self.measure("99 % latency", 1e3 * latencies[len(latencies) * 99 // 100], "ms", high=50)
        self.measure("speed of time", (self.arm.time() - simulated) / elapsed, "", 0.95, 1.05)
        self.keep(samples)

        self.wait_until(
            lambda: abs(self.arm.position("shoulder") + SWING) < 0.02,
            timeout=5,
            what="the shoulder at the end of its swing",
        )

    def tearDown(self) -> None:
        if hasattr(self, "arm"):
            self.arm.move("shoulder", 0.0)
            self.arm.close()

    def keep(self, samples: list[tuple[float, float, float]]) -> None:
        """Keeps the samples with the test's result, for a plot."""
        path = Path(self.folder.name) / "shoulder.csv"
        with path.open("w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["seconds", "shoulder_rad", "latency_s"])
            table.writerows(samples)
        self.attach(path, media_type="text/csv")
