import asyncio

import pytest
from arm import move
from hypothesis import given, settings
from hypothesis import strategies as st

runs = []


def test_passes_in_the_second_attempt():
    runs.append(1)
    assert len(runs) > 1


async def test_awaits():
    await asyncio.sleep(0)


async def test_fails():
    await asyncio.sleep(0)
    assert 0


@settings(max_examples=5, deadline=None, database=None)
@given(number=st.integers())
def test_property(number):
    assert move(number) == number + 1


def test_measures(benchmark):
    assert benchmark(move, 1) == 2


def test_parts(subtests):
    for joint in range(2):
        with subtests.test(joint=joint):
            assert joint == 0


@pytest.mark.repeat(2)
@pytest.mark.parametrize("joint", ["elbow", "a::b"])
def test_repeated(joint):
    assert joint


@pytest.mark.xfail(reason="known")
def test_known():
    assert 0
