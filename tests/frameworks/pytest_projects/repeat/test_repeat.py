import pytest

runs = []


def test_fails_in_the_second_repetition():
    runs.append(1)
    assert len(runs) != 2


class TestArm:
    @pytest.mark.parametrize("joint", ["elbow", "wrist"])
    def test_moves(self, joint):
        assert joint
