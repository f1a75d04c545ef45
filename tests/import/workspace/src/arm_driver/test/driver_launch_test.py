"""Launches a driver."""

import unittest

import launch
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration
from launch_testing.actions import ReadyToTest


def generate_test_description():
    """Starts the driver."""
    side = DeclareLaunchArgument("side")
    driver = ExecuteProcess(
        cmd=["sh", "-c", "echo $0 is on; sleep 1000", LaunchConfiguration("side")]
    )
    return launch.LaunchDescription([side, driver, ReadyToTest()])


class TestDriver(unittest.TestCase):
    """The driver runs."""

    def test_is_on(self, proc_output):
        """It has printed its side."""
        proc_output.assertWaitFor("left is on", timeout=10, stream="stdout")
