"""The description has an argument without a value."""

import unittest


def generate_test_description(speed):
    """Is not called."""
    raise AssertionError(speed)


class TestNothing(unittest.TestCase):
    """Does not run."""

    def test_nothing(self):
        """Does not run."""
