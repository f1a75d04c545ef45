"""A suite that does not run its tests."""

import unittest


class IdleSuite(unittest.TestSuite):
    """Runs nothing."""

    def run(self, result, debug=False):
        return result


class IdleTest(unittest.TestCase):
    """Never runs."""

    def test_passes(self):
        raise AssertionError


def load_tests(loader, tests, pattern):
    """Wraps the tests."""
    return IdleSuite(tests)
