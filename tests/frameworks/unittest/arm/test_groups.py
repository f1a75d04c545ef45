"""Functions for several tests that fail."""

import unittest


class SetUpClassTest(unittest.TestCase):
    """The set-up of the class fails."""

    @classmethod
    def setUpClass(cls):
        raise OSError("no bench")  # line: no bench

    def test_first(self):
        raise AssertionError

    def test_second(self):
        raise AssertionError


class SkippingClassTest(unittest.TestCase):
    """The set-up of the class skips all tests."""

    @classmethod
    def setUpClass(cls):
        raise unittest.SkipTest("no mains")

    def test_first(self):
        raise AssertionError


class TearDownClassTest(unittest.TestCase):
    """The tear-down of the class fails."""

    @classmethod
    def tearDownClass(cls):
        raise OSError("the bench is on fire")

    def test_first(self):
        pass
