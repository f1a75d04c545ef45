"""The description has a mistake."""

import unittest


def generate_test_description():
    """Fails."""
    return {}["robot"]  # line: description


class TestNothing(unittest.TestCase):
    """Does not run."""

    def test_nothing(self):
        """Does not run."""
