def test_robot(robot):
    assert robot == "simulated"


def test_last():
    pass
