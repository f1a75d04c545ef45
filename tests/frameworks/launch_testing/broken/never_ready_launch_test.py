"""The processes are ready too late."""

import unittest

import launch
import launch_testing
from launch.actions import ExecuteProcess, TimerAction
from launch_testing.actions import ReadyToTest


@launch_testing.ready_to_test_action_timeout(1.5)
def generate_test_description():
    """Is ready after a minute."""
    motor = ExecuteProcess(cmd=["sleep", "1000"])
    ready = TimerAction(period=60.0, actions=[ReadyToTest()])
    return launch.LaunchDescription([motor, ready])


class TestNothing(unittest.TestCase):
    """Does not run."""

    def test_nothing(self):
        """Does not run."""
