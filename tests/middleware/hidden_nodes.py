"""A program of signals hears what was published before, and leaves the graph at its end.

    hidden_nodes.py PROGRAM

Needs rclpy and the harness.
"""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Callable

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from run import expect
from std_msgs.msg import Float64


def main(program: str) -> None:
    """It also hears a publisher that comes later and offers less."""
    rclpy.init()
    try:
        observer = rclpy.create_node("observer")
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        publisher = observer.create_publisher(Float64, "/level", latched)
        publisher.publish(Float64(data=0.5))
        values: list[str] = []
        with subprocess.Popen(
            [sys.executable, program, "/level.data"],
            stdout=subprocess.PIPE,
            text=True,
        ) as signals:
            output = signals.stdout or ()
            reading = threading.Thread(
                target=lambda: values.extend(line.split()[1] for line in output)
            )
            reading.start()
            wait_until("the earlier message", lambda: values == ["0.5"], signals)
            expect("a node of signals", len(hidden(observer)), 1)
            less = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
            late = observer.create_publisher(Float64, "/level", less)

            def is_heard() -> bool:
                late.publish(Float64(data=0.75))
                return "0.75" in values

            wait_until("a publisher that offers less", is_heard, signals)
            signals.terminate()
        wait_until("it has left", lambda: hidden(observer) == [])
        observer.destroy_node()
    finally:
        rclpy.try_shutdown()


def hidden(observer: rclpy.node.Node) -> list[str]:
    """The nodes of rtf that a node sees."""
    return [name for name in observer.get_node_names() if name.startswith("_rtf_")]


def wait_until(
    what: str, condition: Callable[[], bool], program: subprocess.Popen[str] | None = None
) -> None:
    """Wait for a condition, and kill the program if it does not hold in time."""
    # Others see a node that did not leave for 20 s after the end of its program.
    limit = 15 if program is None else 120
    deadline = time.monotonic() + limit
    while not condition():
        if time.monotonic() > deadline:
            if program is not None:
                program.kill()
            raise SystemExit(f"not within {limit} s: {what}")
        time.sleep(0.05)
    print(f"ok: {what}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
