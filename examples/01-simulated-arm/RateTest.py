"""How fast can the arm be read? Samples the shoulder while it moves to and fro."""

from __future__ import annotations

import csv
import os
import statistics
import tempfile
import time
from pathlib import Path

import rtf
from arm_client import Arm

SWING = 0.5
"""How far the shoulder swings to each side, in radians."""

FARTHEST = SWING + 0.2
"""How far it may be from the middle at any time, in radians: it must not overshoot."""

PERIOD_SECS = 0.002

Sample = tuple[float, float, float, float]
"""Wall time, simulated time, position in radians, latency; times in seconds."""


class RateTest(rtf.TestCase):
    """Measures rate and latency of the encoders, and whether simulated time is real time."""

    def setup(self, args: list[str]) -> bool:
        self.seconds = float(args[args.index("--seconds") + 1]) if "--seconds" in args else 3.0
        self.arm = Arm()
        self.require("shoulder" in self.arm.joints(), "the arm has a shoulder")
        return True

    def run(self) -> None:
        samples = self.swing()
        elapsed = samples[-1][0] - samples[0][0]
        simulated = samples[-1][1] - samples[0][1]
        latencies = sorted(sample[3] for sample in samples)
        self.measure("sampling rate", len(samples) / elapsed, "Hz", low=100)
        self.measure("median latency", 1e3 * statistics.median(latencies), "ms", high=5)
        self.measure("99 % latency", 1e3 * latencies[len(latencies) * 99 // 100], "ms", high=50)
        self.measure("speed of time", simulated / elapsed, "", 0.9, 1.1)
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

    def swing(self) -> list[Sample]:
        """Reads the arm at the rate of its physics, while the shoulder swings to both sides."""
        samples: list[Sample] = []
        started = time.monotonic()
        self.arm.move("shoulder", SWING)
        while (now := time.monotonic() - started) < self.seconds:
            radians = self.arm.position("shoulder")
            latency = time.monotonic() - started - now
            samples.append((now, self.arm.time(), radians, latency))
            self.sample("shoulder", radians, "rad", low=-FARTHEST, high=FARTHEST)
            if now > self.seconds / 2:
                self.arm.move("shoulder", -SWING)
            self.sleep(PERIOD_SECS)  # ends the test if somebody stops the run
        return samples

    def keep(self, samples: list[Sample]) -> None:
        """Keeps the samples with the test's result, for a plot.

        The runner copies the file while the test goes on: it must not go with
        this process. The next run writes it anew.
        """
        path = Path(tempfile.gettempdir()) / f"rtf-example-01-{os.getuid()}.csv"
        with path.open("w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["seconds", "simulated_seconds", "shoulder_rad", "latency_seconds"])
            table.writerows(samples)
        self.attach(path, "shoulder.csv", "text/csv")
