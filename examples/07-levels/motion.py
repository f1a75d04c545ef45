"""What the tests of several levels do with the arm."""

from __future__ import annotations

import argparse
import contextlib

import lesson_1  # noqa: F401 - makes arm_client known
import rtf
from arm_client import Arm

Pose = dict[str, float]
"""Radians of each joint."""

REST: Pose = {"shoulder": 0.0, "elbow": 0.0, "wrist": 0.0}
LIMIT_SECS = 5.0


class MotionTest(rtf.TestCase):
    """A test that moves the arm, and leaves it at rest."""

    arm: Arm | None = None
    tolerance = 0.05

    def setup(self, args: list[str]) -> None:
        parser = argparse.ArgumentParser(prog=self.name)
        parser.add_argument("--tolerance", type=float, default=self.tolerance)
        self.tolerance = parser.parse_args(args).tolerance
        self.arm = Arm()

    def reach(self, pose: Pose, what: str) -> None:
        """Moves all joints at once, and waits until they are there."""
        arm = self.arm
        assert arm is not None
        for joint, target in pose.items():
            arm.move(joint, target)

        def is_there() -> bool:
            return all(abs(arm.position(j) - at) <= self.tolerance for j, at in pose.items())

        self.wait_until(is_there, timeout=LIMIT_SECS, what=what)

    def tearDown(self) -> None:
        if self.arm is not None:
            # An arm that died has no power: it cannot be brought to rest.
            with contextlib.suppress(ConnectionError):
                for joint, target in REST.items():
                    self.arm.move(joint, target)
            self.arm.close()
