import pytest


@pytest.fixture(scope="session")
def level():
    return "tests"


@pytest.fixture(autouse=True)
def everywhere(level):
    yield


def pytest_collection_modifyitems(items):
    for item in items:
        if "unit" in item.nodeid:
            item.add_marker(pytest.mark.slow)
    items.reverse()
