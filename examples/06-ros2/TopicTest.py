"""Topics: the joint tells often enough where it is, and goes where it is told."""

from __future__ import annotations

from station import StationTest


class TopicTest(StationTest):
    """Sends the joint to and fro, and measures."""

    def run(self) -> None:
        self.arrive(0.0, timeout=20)
        begun = len(self.positions)
        for goal in (0.8, -0.8, 0.0):
            self.arrive(goal, timeout=20)
        heard = self.positions[begun:]
        seconds = heard[-1][0] - heard[0][0]
        self.measure("rate of position", (len(heard) - 1) / seconds, "Hz", low=10)
        self.check_near(max(at for _, at in heard), 0.8, 1e-6, "the furthest to one side, in rad")
        self.check_near(min(at for _, at in heard), -0.8, 1e-6, "the furthest to the other, in rad")
