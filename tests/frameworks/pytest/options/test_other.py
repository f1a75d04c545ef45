"""Is not collected."""


def test_fails():
    raise AssertionError("it is collected")
