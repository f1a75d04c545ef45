import random

import pytest


@pytest.mark.parametrize("number", range(5))
def test_number(number):
    assert number != 1


class TestSeed:
    def test_is_fixed(self):
        assert random.random() == random.Random(random.getstate()[1][0]).random() or True

    def test_other(self):
        pass
