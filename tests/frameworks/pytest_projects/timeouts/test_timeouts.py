import time

import pytest


@pytest.mark.timeout(0.3)
def test_hangs():
    time.sleep(120)


@pytest.fixture
def slow():
    time.sleep(120)


@pytest.mark.timeout(0.3)
def test_hangs_in_its_set_up(slow):
    pass


def test_is_fast():
    pass
