"""A module is missing."""

import no_such_robot  # line: import


def generate_test_description():
    """Is not called."""
    return no_such_robot.launch()
