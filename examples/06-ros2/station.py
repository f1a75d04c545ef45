"""What the tests of this lesson share: a node of their own that hears, tells and asks."""

from __future__ import annotations

import threading
import time
from typing import Any

import rclpy
import rtf
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import Float64, String

ANSWER_SECS = 20.0
"""How long the joint may take to be found, or to answer."""


class StationTest(rtf.TestCase):
    """A test with a node, which listens in the background."""

    def setup(self, args: list[str]) -> bool:  # noqa: ARG002
        rclpy.init()
        self.node = rclpy.create_node("station")
        self.positions: list[tuple[float, float]] = []
        self.robots: set[str] = set()
        self.node.create_subscription(Float64, "position", self.position_came, 10)
        self.node.create_subscription(String, "robot", self.robot_came, 10)
        self.goals = self.node.create_publisher(Float64, "goal", 10)
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.thread = threading.Thread(target=self.executor.spin, daemon=True)
        self.thread.start()
        self.wait_until(self.joint_is_there, ANSWER_SECS, "the joint to be there")
        return True

    def tearDown(self) -> None:
        if hasattr(self, "node"):
            self.executor.shutdown()
            self.thread.join()
            self.node.destroy_node()
            rclpy.shutdown()

    def joint_is_there(self) -> bool:
        """Whether it is heard and hears us. A message counts, the graph forgets too slowly."""
        return bool(self.positions) and self.goals.get_subscription_count() > 0

    def position_came(self, message: Float64) -> None:
        """Keep a position, in radians, with the time in seconds."""
        self.positions.append((time.monotonic(), message.data))

    def robot_came(self, message: String) -> None:
        """Keep who tells."""
        self.robots.add(message.data)

    def position(self) -> float:
        """Where the joint is, in radians."""
        return self.positions[-1][1]

    def go(self, goal: float) -> None:
        """Send the joint to a goal, in radians."""
        self.goals.publish(Float64(data=goal))

    def arrive(self, goal: float, timeout: float) -> None:
        """Go there, and wait until it is reached."""
        self.go(goal)
        what = f"the joint at {goal} rad"
        self.wait_until(lambda: abs(self.position() - goal) < 1e-6, timeout, what)

    def call(self, kind: Any, service: str, request: Any) -> Any:
        """Call a service and return its answer."""
        client = self.node.create_client(kind, service)
        self.require(client.wait_for_service(ANSWER_SECS), f"{service} is there")
        future = client.call_async(request)
        self.wait_until(future.done, ANSWER_SECS, f"an answer of {service}")
        return future.result()
