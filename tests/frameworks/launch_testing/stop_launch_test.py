"""One of two processes dies while a test runs."""

import time
import unittest

import launch
from launch.actions import ExecuteProcess
from launch_testing.actions import ReadyToTest


def generate_test_description():
    """Starts a driver that dies, and a motor."""
    driver = ExecuteProcess(cmd=["sh", "-c", "sleep 1; exit 7"])
    motor = ExecuteProcess(cmd=["sleep", "1000"])
    return launch.LaunchDescription([driver, motor, ReadyToTest()])


class TestDriver(unittest.TestCase):
    """The driver dies."""

    def test_1_while_it_dies(self):
        """Takes ten seconds."""
        time.sleep(10)

    def test_2_after(self):
        """Passes."""
