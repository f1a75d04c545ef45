"""Fixtures of the corpus, and a hook as users have them."""

import pytest


def pytest_collection_modifyitems(items):
    """Runs a test last."""
    items.sort(key=lambda item: item.name == "test_runs_last")


@pytest.fixture
def robot():
    """A robot that cannot be reached."""
    raise OSError("no robot at 192.0.2.1")  # line: no robot


@pytest.fixture
def gripper():
    """A gripper that does not open."""
    yield "gripper"
    raise OSError("the gripper is stuck")  # line: stuck
