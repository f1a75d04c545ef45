"""All processes die while a test runs."""

import time
import unittest

import launch
import launch_testing
from launch.actions import ExecuteProcess
from launch_testing.actions import ReadyToTest


def generate_test_description():
    """Starts a driver that dies."""
    driver = ExecuteProcess(cmd=["sh", "-c", "sleep 1; echo voltage is low >&2; kill -SEGV $$"])
    return launch.LaunchDescription([driver, ReadyToTest()])


class TestDriver(unittest.TestCase):
    """The driver dies."""

    def test_1_before(self):
        """Passes."""

    def test_2_while_it_dies(self):
        """Never finishes."""
        time.sleep(100)

    def test_3_after(self):
        """Does not run."""


@launch_testing.post_shutdown_test()
class TestEnd(unittest.TestCase):
    """Does not run."""

    def test_end(self):
        """Does not run."""
