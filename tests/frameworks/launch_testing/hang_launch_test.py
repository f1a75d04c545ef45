"""A test hangs, and processes that it launched remain."""

import time
import unittest

import launch
from launch.actions import ExecuteProcess
from launch_testing.actions import ReadyToTest

PARKS = "trap 'echo parks; sleep 0.2; echo parked; exit 0' INT; while sleep 0.05; do :; done"


def generate_test_description():
    """Starts a motor that parks, and a shell with a child."""
    motor = ExecuteProcess(cmd=["sh", "-c", PARKS], output="screen")
    shell = ExecuteProcess(cmd=["sleep 1000 & wait"], shell=True)
    return launch.LaunchDescription([motor, shell, ReadyToTest()])


class TestHang(unittest.TestCase):
    """The second test hangs."""

    def test_1_before(self):
        """Passes."""

    def test_2_hangs(self):
        """Hangs."""
        time.sleep(1000)  # line: hangs

    def test_3_after(self):
        """Runs on a second launch."""
