import os


def test_before():
    pass


def test_ends_its_worker():
    os._exit(3)


def test_after():
    assert 0
