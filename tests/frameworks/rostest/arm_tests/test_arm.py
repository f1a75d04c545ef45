#!/usr/bin/python3
"""A node with tests of all kinds of results."""

import unittest

import rospy
import rostest


class TestArm(unittest.TestCase):
    """Reads a parameter of the launch file."""

    def test_moves(self) -> None:
        """Passes."""
        self.assertEqual(rospy.get_param("/speed"), 3)

    def test_fails(self) -> None:
        """Fails."""
        self.assertEqual(rospy.get_param("/speed"), 7, "the arm <left> & ü")  # line: fails

    def test_error(self) -> None:
        """Has an error."""
        raise RuntimeError("no power")  # line: error


if __name__ == "__main__":
    rospy.init_node("test_arm")
    rostest.rosrun("arm_tests", "test_arm", TestArm)
