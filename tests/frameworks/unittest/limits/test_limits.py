"""A test that passes without rtf."""

import unittest

import rtf.session


class LimitTest(unittest.TestCase):
    """Measures."""

    def test_exceeds_limit(self):
        rtf.session.current().measure("overshoot", 0.3, "rad", high=0.1)
