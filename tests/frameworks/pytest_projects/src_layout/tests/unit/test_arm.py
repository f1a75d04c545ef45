import arm


class TestArm:
    class TestInner:
        def test_speed(self):
            assert arm.SPEED == 2


def test_level(level):
    assert level == "tests/unit"
