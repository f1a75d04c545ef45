"""The cases of tests/frameworks/promises.json."""

import os
import subprocess
import unittest

import launch
import rtf.session
from launch_testing.actions import ReadyToTest
from launch_testing.markers import keep_alive


@keep_alive
def generate_test_description():
    """Starts nothing: a crash would leave it."""
    return launch.LaunchDescription([ReadyToTest()])


class Promises(unittest.TestCase):
    """Three cases."""

    def test_1_first(self):
        """Passes."""

    def test_2_second(self):
        """Runs the command."""
        shell = subprocess.Popen(["sh", "-c", os.environ["PROMISE"]])
        self.assertEqual(shell.wait(), 0)

    def test_3_third(self):
        """Measures, if it should."""
        if "MEASURES" in os.environ:
            limit = float(os.environ["MEASURES"])
            rtf.session.current().measure("force", 2.5, "N", high=limit)
