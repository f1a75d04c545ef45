#!/usr/bin/python3
"""The cases of tests/frameworks/promises.json."""

import os
import subprocess
import unittest

import rostest


class Promises(unittest.TestCase):
    """Three cases."""

    def test_1_first(self) -> None:
        """Passes."""

    def test_2_second(self) -> None:
        """Runs the command."""
        shell = subprocess.Popen(["sh", "-c", os.environ["PROMISE"]])
        self.assertEqual(shell.wait(), 0)

    def test_3_third(self) -> None:
        """Passes."""


if __name__ == "__main__":
    rostest.rosrun("arm_tests", "promises", Promises)
