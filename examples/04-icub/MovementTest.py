"""Does a joint follow a movement? Leads it along a minimum-jerk reference, there and back."""

from __future__ import annotations

import argparse
import time

import rtf
import yarp
from icub_client import Part

PERIOD_SECS = 0.02


class MovementTest(rtf.TestCase):
    """Follows a reference with one joint and measures how far behind it is."""

    def setup(self, args: list[str]) -> None:
        parser = argparse.ArgumentParser(prog=self.name)
        parser.add_argument("--part", required=True)
        parser.add_argument("--joint", required=True)
        parser.add_argument("--amplitude", type=float, default=30.0, metavar="DEGREES")
        parser.add_argument("--duration", type=float, default=2.0, metavar="SECONDS")
        self.options = parser.parse_args(args)
        self.network = yarp.Network()
        self.part = Part(self, self.options.part)
        if self.options.joint not in self.part.names:
            self.error(f"{self.options.part} has the joints {', '.join(self.part.names)}")
        self.joint = self.part.names.index(self.options.joint)
        self.home = self.part.degrees()

    def run(self) -> None:
        there = self.home[self.joint] + self.options.amplitude
        errors = self.follow(self.home[self.joint], there)
        errors += self.follow(there, self.home[self.joint])
        rms = (sum(error * error for error in errors) / len(errors)) ** 0.5
        self.measure("tracking error, RMS", rms, "deg", high=6.0)
        self.measure("tracking error, worst", max(map(abs, errors)), "deg", high=12.0)

    def follow(self, start: float, end: float) -> list[float]:
        """Leads the joint from `start` to `end`; how far it was off the reference."""
        errors = []
        began = time.monotonic()
        reference = start
        while (passed := time.monotonic() - began) < self.options.duration:
            errors.append(self.part.degrees()[self.joint] - reference)
            reference = start + (end - start) * minimum_jerk(passed / self.options.duration)
            target = list(self.home)
            target[self.joint] = reference
            self.part.send(target)
            self.sleep(PERIOD_SECS)
        return errors

    def tearDown(self) -> None:
        if hasattr(self, "home"):
            self.part.send(self.home)
        if hasattr(self, "part"):
            self.part.close()


def minimum_jerk(phase: float) -> float:
    """Return the way from 0 to 1 that people's arms take (Flash and Hogan, 1985)."""
    return phase**3 * (10 - 15 * phase + 6 * phase * phase)
