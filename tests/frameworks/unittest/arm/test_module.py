"""The set-up of the module fails."""

import unittest


def setUpModule():
    """Fails."""
    raise OSError("no floor")  # line: no floor


class ModuleTest(unittest.TestCase):
    """Never runs."""

    def test_first(self):
        raise AssertionError
