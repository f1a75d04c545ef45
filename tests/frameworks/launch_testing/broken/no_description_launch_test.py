"""Describes no launch."""

import unittest


class TestNothing(unittest.TestCase):
    """Does not run."""

    def test_nothing(self):
        """Does not run."""
