import pytest
from arm import move


def test_moves(benchmark):
    assert benchmark(move, 1) == 2


def test_raises():
    with pytest.raises(ValueError):
        move(-1)


def test_fails(benchmark):
    assert benchmark(move, 1) == 3
