#!/usr/bin/python3
"""The rover's wheel: takes a speed on `command`, tells its own on `speed`, 50 times a second."""

import contextlib

import rospy
from std_msgs.msg import Float64
from std_srvs.srv import Trigger, TriggerRequest, TriggerResponse

RATE_HZ = 50


class Wheel:
    """Turns as it is told, less what it slips."""

    def __init__(self) -> None:
        self.slip = float(rospy.get_param("~slip", 0.0))
        self.speed = 0.0
        self.told = rospy.Publisher("speed", Float64, queue_size=10)
        rospy.Subscriber("command", Float64, self.command)
        rospy.Service("stop", Trigger, self.stop)

    def command(self, message: Float64) -> None:
        """Turn at this speed, in m/s."""
        self.speed = message.data * (1.0 - self.slip)

    def stop(self, _: TriggerRequest) -> TriggerResponse:
        """Stand still."""
        self.speed = 0.0
        return TriggerResponse(success=True, message="stopped")

    def turn(self) -> None:
        """Tell the speed until ROS ends."""
        rate = rospy.Rate(RATE_HZ)
        while not rospy.is_shutdown():
            self.told.publish(self.speed)
            rate.sleep()


if __name__ == "__main__":
    rospy.init_node("wheel")
    # That is how ROS ends.
    with contextlib.suppress(rospy.ROSInterruptException):
        Wheel().turn()
