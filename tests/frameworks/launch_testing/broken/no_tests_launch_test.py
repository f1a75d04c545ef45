"""Has no tests."""

import launch
from launch_testing.actions import ReadyToTest


def generate_test_description():
    """Starts nothing."""
    return launch.LaunchDescription([ReadyToTest()])
