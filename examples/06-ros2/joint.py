"""A joint as a ROS 2 node: it goes where it is told, not faster than it may.

Topics: `position` and `goal` in radians, `robot` with the name of its robot.
Service: `motor` switches it on and off. Parameter: `speed_limit` in rad/s.
"""

from __future__ import annotations

import os
import signal

import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
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
    stops: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, _frame: stops.append(number))
    # With rclpy's handlers, `step` could publish after a signal has shut the context down.
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = Joint()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    print(f"{node.robot}: joint is ready", flush=True)
    while not stops:
        executor.spin_once(timeout_sec=0.1)
    rclpy.shutdown()


if __name__ == "__main__":
    main()
