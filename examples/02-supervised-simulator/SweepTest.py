"""Tests whether the shoulder follows while it sweeps to and fro."""

from __future__ import annotations

import argparse
import math
import time

import lesson_1  # noqa: F401 - makes arm_client known
import rtf
from arm_client import Arm

AMPLITUDE_RAD = 0.8
PERIOD_SECS = 4.0


class SweepTest(rtf.TestCase):
    """Moves the shoulder along a sine and measures how far it lags behind."""

    arm: Arm | None = None

    def setup(self, args: list[str]) -> None:
        parser = argparse.ArgumentParser(prog=self.name)
        parser.add_argument("--seconds", type=float, default=6.0)
        self.seconds = parser.parse_args(args).seconds
        self.arm = Arm()

    def run(self) -> None:
        assert self.arm is not None
        worst = 0.0
        started = time.monotonic()
        # The loop may be stopped at any moment: that is what tearDown is for.
        while (now := time.monotonic() - started) < self.seconds:
            target = AMPLITUDE_RAD * math.sin(2 * math.pi * now / PERIOD_SECS)
            self.arm.move("shoulder", target)
            worst = max(worst, abs(target - self.arm.position("shoulder")))
            self.sleep(0.02)
        self.measure("worst lag", worst, "rad", high=0.5)

    def tearDown(self) -> None:
        if self.arm is not None:
            self.arm.close()
