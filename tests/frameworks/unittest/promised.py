"""The cases of tests/frameworks/promises.json."""

import os
import subprocess
import unittest

import rtf.session


class Promises(unittest.TestCase):
    """Three cases."""

    def test_1_first(self) -> None:
        """Passes."""

    def test_2_second(self) -> None:
        """Runs the command."""
        shell = subprocess.Popen(["sh", "-c", os.environ["PROMISE"]])
        self.assertEqual(shell.wait(), 0)

    def test_3_third(self) -> None:
        """Measures, if it should."""
        if "MEASURES" in os.environ:
            limit = float(os.environ["MEASURES"])
            rtf.session.current().measure("force", 2.5, "N", high=limit)
