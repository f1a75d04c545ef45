"""One joint in several poses, each a case."""

from __future__ import annotations

from functools import partial

import lesson_1  # noqa: F401 - makes arm_client known
import rtf
from arm_client import Arm

POSES = {"low": -0.4, "middle": 0.0, "high": 0.4}
"""Radians."""
TOLERANCE = 0.05


class PosesTest(rtf.TestCase):
    """Runs once for each joint and load of the suite's matrix."""

    def setup(self, args: list[str]) -> None:
        if args:
            self.error("the joint and its load are parameters of the matrix")
        self.arm = Arm(int(self.fixture_value("arm.port")))
        self.joint = self.parameter("joint")

    def run(self) -> None:
        self.plan_cases(list(POSES))
        for name, angle in POSES.items():
            with self.case(name, angle=angle):
                if self.parameter("load") == "full" and name == "high":
                    self.skip("the simulated arm has no weight to lift")
                self.arm.move(self.joint, angle)
                self.wait_until(partial(self.is_at, angle), 5, f"{self.joint} at {angle} rad")
                self.measure("error", abs(self.arm.position(self.joint) - angle), "rad", high=0.1)

    def is_at(self, angle: float) -> bool:
        """Whether the joint is close to this angle, in radians."""
        return abs(self.arm.position(self.joint) - angle) <= TOLERANCE

    def tearDown(self) -> None:
        self.arm.move(self.joint, 0.0)
        self.arm.close()
