"""Ends a subscriber of a replay in ROS 1: the next one of its name has not come yet.

Needs Debian's Python with rospy, the library `mcap`, the harness and the fixtures.
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rtf_fixtures.replay.model import Kind
from rtf_fixtures.replay.ros1_sender import Ros1Sender
from run import expect

# A busy machine is slow, not wrong.
LIMIT_SECS = 60
SUBSCRIBERS = [("/watcher", "/level")]
WATCHER = """
import rospy
from std_msgs.msg import Float64

rospy.init_node("watcher", disable_signals=True)
rospy.Subscriber("/level", Float64, lambda message: None)
rospy.spin()
"""


def main() -> None:
    """Runs a master, a sender and a subscriber."""
    with (
        tempfile.TemporaryDirectory() as directory,
        socket.create_server(("127.0.0.1", 0)) as taken,
    ):
        port = taken.getsockname()[1]
        taken.close()
        os.environ |= {
            "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
            "ROS_IP": "127.0.0.1",
            "ROS_HOME": directory,
        }
        with running(["rosmaster", "--core", "-p", str(port)]):
            wait_until(lambda: is_open(port))
            sender = Ros1Sender("rtf_check")
            sender.open("/level", "/level", Kind("number", ""))
            with running([sys.executable, "-c", WATCHER]) as watcher:
                wait_until(lambda: sender.missing(SUBSCRIBERS) == "")
                watcher.kill()
                watcher.wait()
                missing = "the node /watcher does not subscribe to /level"
                expect("after its end", sender.missing(SUBSCRIBERS), missing)
            sender.close()


@contextmanager
def running(command: list[str]) -> Iterator[subprocess.Popen[bytes]]:
    """A process that is killed at the end."""
    process = subprocess.Popen(command)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def is_open(port: int) -> bool:
    """Whether a server listens."""
    with socket.socket() as client:
        return client.connect_ex(("127.0.0.1", port)) == 0


def wait_until(condition: Callable[[], bool]) -> None:
    """Waits; fails at the limit."""
    end = time.monotonic() + LIMIT_SECS
    while not condition():
        if time.monotonic() > end:
            sys.exit(f"not within {LIMIT_SECS} s")
        time.sleep(0.01)


if __name__ == "__main__":
    main()
