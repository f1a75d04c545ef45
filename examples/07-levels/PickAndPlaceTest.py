"""System: the whole task, seen from outside. Nobody asks how it is done."""

from __future__ import annotations

import time

from motion import REST, MotionTest

ABOVE = {"shoulder": 0.3, "elbow": -0.6, "wrist": 0.2}
PICK = {"shoulder": 0.5, "elbow": -0.8, "wrist": 0.4}
PLACE = {"shoulder": -0.5, "elbow": 0.8, "wrist": -0.4}


class PickAndPlaceTest(MotionTest):
    """From rest over the pick to the place, and back to rest."""

    def run(self) -> None:
        started = time.monotonic()
        steps = {"above": ABOVE, "at the pick": PICK, "at the place": PLACE, "at rest": REST}
        for what, pose in steps.items():
            self.report(what)
            self.reach(pose, f"the arm {what}")
        self.measure("cycle time", time.monotonic() - started, "s", high=15)
