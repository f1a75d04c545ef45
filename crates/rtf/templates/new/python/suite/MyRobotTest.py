"""Tests the joint of the robot."""

from pathlib import Path

import rtf


class MyRobotTest(rtf.TestCase):
    """rtf calls setup, run and tearDown, in a separate process for each test."""

    def setup(self, args: list[str]) -> None:
        """Connect here. A problem in setup is an `error`: the bench is wrong, not the robot."""
        self.goal = float(args[0])  # param in the suite
        self.state = Path(self.fixture_value("simulator.state"))

    def run(self) -> None:
        """Test here. The first problem decides the verdict."""
        # Ends the test if it takes longer than 10 s.
        self.wait_until(lambda: self.position() >= self.goal, 10, "the joint at its goal")
        # A failed check does not end the test.
        self.check_near(self.position(), self.goal, 0.5, "joint")
        # Stored with the result, and checked against the limits.
        self.measure("position", self.position(), "deg", low=0, high=180)

    def tearDown(self) -> None:
        """Leave the robot as it was. rtf always calls it."""

    def position(self) -> float:
        """Read the position from the stand-in for the robot."""
        return float(self.state.read_text())
