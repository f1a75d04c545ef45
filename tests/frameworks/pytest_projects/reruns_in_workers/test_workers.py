import pytest

runs = []


def test_passes_in_the_second_attempt():
    runs.append(1)
    assert len(runs) > 1


@pytest.mark.parametrize("joint", range(6))
def test_moves(joint):
    assert joint != 4


@pytest.fixture
def breaks_at_the_end():
    yield
    raise OSError("does not stop")


def test_is_never_torn_down(breaks_at_the_end):
    pass
