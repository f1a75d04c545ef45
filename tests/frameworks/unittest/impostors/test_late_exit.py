"""A module that ends the process after its tests."""

import os
import unittest


def tearDownModule():
    """Ends before the report is complete."""
    os._exit(0)


class LateExitTest(unittest.TestCase):
    """Passes."""

    def test_passes(self):
        pass
