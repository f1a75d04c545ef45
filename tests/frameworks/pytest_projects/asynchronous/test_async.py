import asyncio

import pytest


@pytest.fixture
async def arm():
    await asyncio.sleep(0)
    yield "arm"
    await asyncio.sleep(0)


async def test_moves(arm):
    assert arm == "arm"


async def test_fails(arm):
    await asyncio.sleep(0)
    assert arm == "leg"


class TestInClass:
    async def test_awaits(self, arm):
        await asyncio.gather(*(asyncio.sleep(0) for _ in range(3)))

    @pytest.mark.parametrize("speed", [0.5, 1.0])
    async def test_speed(self, speed):
        assert speed < 1


async def test_ends_with_an_error_in_a_task():
    async def breaks():
        raise ValueError("lost")

    await asyncio.create_task(breaks())
