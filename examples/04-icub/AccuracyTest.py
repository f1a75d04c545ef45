"""Does an arm go where it is sent? Moves it through some postures and measures each joint."""

from __future__ import annotations

import argparse

import rtf
import yarp
from icub_client import Part

POSTURES = (
    (-30.0, 40.0, 20.0, 60.0, 20.0, -20.0, 10.0),
    (-60.0, 80.0, -10.0, 90.0, -20.0, 10.0, -10.0),
    (0.0, 10.0, 0.0, 30.0, 0.0, 0.0, 0.0),
)
"""Degrees, a joint each: shoulder (pitch, roll, yaw), elbow, wrist (prosup, pitch, yaw)."""

TOLERANCE_DEG = 3.0


class AccuracyTest(rtf.TestCase):
    """Moves all joints of an arm at once, and looks where they end."""

    def setup(self, args: list[str]) -> None:
        parser = argparse.ArgumentParser(prog=self.name)
        parser.add_argument("--part", required=True)
        self.network = yarp.Network()
        self.part = Part(self, parser.parse_args(args).part)

    def run(self) -> None:
        for number, posture in enumerate(POSTURES, 1):
            self.part.send(list(posture))
            reached = self.rest()
            for joint, got, wanted in zip(self.part.names, reached, posture, strict=True):
                self.measure(
                    f"posture {number}, {joint}",
                    got - wanted,
                    "deg",
                    -TOLERANCE_DEG,
                    TOLERANCE_DEG,
                )

    def rest(self) -> list[float]:
        """Waits until no joint moves more than 0.1 degrees in 0.2 s."""
        before = self.part.degrees()

        def stands() -> bool:
            nonlocal before
            self.sleep(0.2)
            now = self.part.degrees()
            moved = max(abs(a - b) for a, b in zip(now, before, strict=True))
            before = now
            return moved < 0.1

        self.wait_until(stands, 15, "the arm to stand still")
        return before

    def tearDown(self) -> None:
        if hasattr(self, "part"):
            self.part.close()
