"""Integration: servos, physics and encoders agree on where the arm is."""

from __future__ import annotations

import time

from motion import REST, MotionTest

STRETCHED = {"shoulder": 0.4, "elbow": -0.5, "wrist": 0.3}


class ReachTest(MotionTest):
    """Moves all joints at once to a pose and back."""

    def run(self) -> None:
        started = time.monotonic()
        self.reach(STRETCHED, "the arm stretched")
        self.measure("time to reach", time.monotonic() - started, "s", high=5)
        self.reach(REST, "the arm at rest")
