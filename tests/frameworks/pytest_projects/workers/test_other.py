import pytest


@pytest.mark.parametrize("number", range(8))
def test_number(number):
    assert number != 3


@pytest.mark.xfail(strict=True)
def test_passes_unexpectedly():
    pass
