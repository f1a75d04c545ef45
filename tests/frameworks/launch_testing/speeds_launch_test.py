"""Two launches, of which the second has a problem."""

import unittest

import launch
import launch_testing
from launch.actions import ExecuteProcess
from launch_testing.actions import ReadyToTest


@launch_testing.parametrize("speed", [0.5, 1.5])
def generate_test_description(speed):
    """Starts a process for each speed."""
    process = ExecuteProcess(cmd=["sh", "-c", f"echo speed {speed}; exec sleep 1000"])
    return launch.LaunchDescription([process, ReadyToTest()])


class TestSpeed(unittest.TestCase):
    """The process runs."""

    def test_is_set(self, proc_output, speed):
        """Passes."""
        proc_output.assertWaitFor(f"speed {speed}", timeout=10, stream="stdout")

    def test_is_slow(self, speed):
        """Fails at the second speed."""
        self.assertLess(speed, 1.0)  # line: too fast


@launch_testing.post_shutdown_test()
class TestEnd(unittest.TestCase):
    """The process has ended."""

    def test_speed(self, speed):
        """Passes."""
        self.assertGreater(speed, 0)
