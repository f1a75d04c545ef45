"""All tests run when the processes have ended."""

import unittest

import launch
import launch_testing
from launch.actions import ExecuteProcess
from launch_testing.actions import ReadyToTest


def generate_test_description():
    """Starts a process."""
    return launch.LaunchDescription([ExecuteProcess(cmd=["sleep", "1000"]), ReadyToTest()])


@launch_testing.post_shutdown_test()
class TestEnd(unittest.TestCase):
    """The process has ended."""

    def test_was_stopped(self, proc_info):
        """Passes."""
        for event in proc_info:
            self.assertEqual(event.returncode, -2)
