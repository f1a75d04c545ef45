"""Looks whether the odometer tells the distance often enough, all the time."""

import time

import rospy
import rtf
from std_msgs.msg import Float64


class RateTest(rtf.TestCase):
    """Listens for a while: `--seconds 2 --least 20` (messages a second)."""

    def setup(self, args: list[str]) -> None:
        given = dict(zip(args[::2], args[1::2], strict=True))
        self.seconds = float(given.get("--seconds", "2"))
        self.least = float(given.get("--least", "20"))
        rospy.init_node("rate_test", anonymous=True, disable_signals=True)
        self.messages = 0
        rospy.Subscriber("/rover/distance", Float64, self.heard)
        self.wait_until(lambda: self.messages > 0, 10, "a first distance")

    def heard(self, _: Float64) -> None:
        """Count it."""
        self.messages += 1

    def run(self) -> None:
        before, started = self.messages, time.monotonic()
        self.sleep(self.seconds)
        rate = (self.messages - before) / (time.monotonic() - started)
        self.measure("distances", rate, "Hz", self.least)

    def tearDown(self) -> None:
        rospy.signal_shutdown("the test is over")
