def test_phases(is_shutdown=None):
    assert is_shutdown in (False, True)


def test_phases_fail_at_the_end(is_shutdown=None):
    assert not is_shutdown


def test_plain():
    pass
