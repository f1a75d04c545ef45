"""A joint as a ROS 2 node: it goes where it is told, not faster than it may.

Topics: `position` and `goal` in radians, `robot` with the name of its robot.
Service: `motor` switches it on and off. Parameter: `speed_limit` in rad/s.
"""

from __future__ import annotations

import contextlib
import os

import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool

PERIOD_SECS = 0.02
FASTEST = 2.0
"""The highest limit that the motor can bear, in rad/s."""


class Joint(Node):  # type: ignore[misc]  # rclpy has no types
    """One joint of the robot that is named in `ROBOT`."""

    def __init__(self) -> None:
        super().__init__("joint")
        self.robot = os.environ["ROBOT"]
        self.position = 0.0
        self.goal = 0.0
        self.is_on = True
        limits = FloatingPointRange(from_value=0.1, to_value=FASTEST)
        self.declare_parameter(
            "speed_limit", 1.0, ParameterDescriptor(floating_point_range=[limits])
        )
        self.positions = self.create_publisher(Float64, "position", 10)
        self.robots = self.create_publisher(String, "robot", 10)
        self.create_subscription(Float64, "goal", self.go, 10)
        self.create_service(SetBool, "motor", self.switch)
        self.create_timer(PERIOD_SECS, self.step)

    def go(self, goal: Float64) -> None:
        """Take a new goal."""
        self.goal = goal.data

    def switch(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Switch the motor on or off; it forgets where it was going."""
        self.is_on = request.data
        self.goal = self.position
        response.success = True
        response.message = f"{self.robot}: {'on' if self.is_on else 'off'}"
        return response

    def step(self) -> None:
        """Move for one period, and tell."""
        reach = self.get_parameter("speed_limit").value * PERIOD_SECS
        if self.is_on:
            self.position += min(max(self.goal - self.position, -reach), reach)
        self.positions.publish(Float64(data=self.position))
        self.robots.publish(String(data=self.robot))


def main() -> None:
    """Run it until it is stopped."""
    rclpy.init()
    node = Joint()
    print(f"{node.robot}: joint is ready", flush=True)
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)


if __name__ == "__main__":
    main()
