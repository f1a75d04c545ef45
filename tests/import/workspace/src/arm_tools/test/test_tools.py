"""A test of a Python package."""

import arm_tools


def test_tools() -> None:
    """The package was installed by colcon."""
    assert arm_tools.SPEED == 3
