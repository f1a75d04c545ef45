"""Has the name of another file."""


def test_passes():
    pass
