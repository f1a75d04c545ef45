"""The only process dies before it is ready."""

import unittest

import launch
from launch.actions import ExecuteProcess, RegisterEventHandler
from launch.event_handlers import OnProcessIO
from launch_testing.actions import ReadyToTest


def generate_test_description():
    """Is ready when the driver says so."""
    driver = ExecuteProcess(cmd=["sh", "-c", "exit 4"])
    ready = ReadyToTest()

    def on_line(event):
        return ready if event.text == b"ready\n" else None

    handler = OnProcessIO(on_stdout=on_line, on_stderr=on_line)
    # An action that is never executed, where launch_testing searches it.
    return launch.LaunchDescription([driver, RegisterEventHandler(handler), Never([ready])])


class Never(launch.LaunchDescriptionEntity):
    """Does nothing."""

    def __init__(self, entities):
        self.entities = entities

    def describe_sub_entities(self):
        """The actions."""
        return self.entities

    def visit(self, context):
        """Executes nothing."""


class TestNothing(unittest.TestCase):
    """Does not run."""

    def test_nothing(self):
        """Does not run."""
