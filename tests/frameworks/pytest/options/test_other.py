"""Is not collected."""


def test_fails():
    assert False
