"""Tests of unittest, run by tap.py."""

import unittest


class ArmTest(unittest.TestCase):
    """All kinds of results."""

    def test_moves(self) -> None:
        """Passes, and has a docstring."""

    def test_fails(self) -> None:
        self.assertEqual(41, 42)  # line: python

    @unittest.skip("no gripper")
    def test_skips(self) -> None:
        pass


if __name__ == "__main__":
    unittest.main()
