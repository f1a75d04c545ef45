"""The arm carries its payload to a pose, and stays near it."""

from __future__ import annotations

import argparse

import lesson_1  # noqa: F401 - makes `arm_client` known
import rtf
from arm_client import Arm

POSE = [0.4, -0.3, 0.2]
"""Radians of shoulder, elbow and wrist."""


class CarryTest(rtf.TestCase):
    """Carries the payload, and measures by how much the arm sags."""

    def setup(self, args: list[str]) -> None:
        parser = argparse.ArgumentParser(prog=self.name)
        parser.add_argument("--tolerance", type=float, default=0.05)
        self.tolerance = parser.parse_args(args).tolerance
        self.arm = Arm()

    def run(self) -> None:
        targets = " ".join(str(target) for target in POSE)
        reached = [float(word) for word in self.arm.ask(f"carry {targets}").split()]
        error = max(abs(at - target) for at, target in zip(reached, POSE, strict=True))
        self.measure("error", error, "rad", high=self.tolerance)

    def tearDown(self) -> None:
        self.arm.close()
