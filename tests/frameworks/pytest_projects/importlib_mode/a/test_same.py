from pathlib import Path


def test_name():
    assert Path(__file__).parent.name == "a"


def test_fails_in_a():
    assert Path(__file__).parent.name == "b"
