"""Does not say when it is ready."""

import unittest

import launch


def generate_test_description():
    """Starts nothing."""
    return launch.LaunchDescription([])


class TestNothing(unittest.TestCase):
    """Does not run."""

    def test_nothing(self):
        """Does not run."""
