"""Looks whether the wheel turns as it is told, and stands still when it is stopped."""

import rospy
import rtf
from std_msgs.msg import Float64
from std_srvs.srv import Trigger


class StopTest(rtf.TestCase):
    """Drives, and calls the service that stops."""

    def setup(self, _: list[str]) -> None:
        # Signals are rtf's affair.
        rospy.init_node("stop_test", anonymous=True, disable_signals=True)
        self.speed = float("nan")
        rospy.Subscriber("/rover/speed", Float64, self.heard)
        self.command = rospy.Publisher("/rover/command", Float64, queue_size=1, latch=True)
        rospy.wait_for_service("/rover/stop", timeout=10)

    def heard(self, message: Float64) -> None:
        """Keep the speed."""
        self.speed = message.data

    def run(self) -> None:
        self.command.publish(0.3)
        self.wait_until(lambda: self.speed == 0.3, 5, "the wheel turns at 0.3 m/s")
        answer = rospy.ServiceProxy("/rover/stop", Trigger)()
        self.check(answer.success, "the wheel says that it stops")
        self.wait_until(lambda: self.speed == 0.0, 5, "the wheel stands still")

    def tearDown(self) -> None:
        rospy.signal_shutdown("the test is over")
