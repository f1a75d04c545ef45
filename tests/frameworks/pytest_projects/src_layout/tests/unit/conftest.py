import pytest


@pytest.fixture
def level(level):
    return level + "/unit"
