import pytest

runs = {"call": 0, "setup": 0, "teardown": 0}


def test_passes():
    pass


def test_passes_in_the_second_attempt():
    runs["call"] += 1
    assert runs["call"] > 1, f"attempt {runs['call']}"


def test_fails_in_all_attempts():
    assert 0


@pytest.fixture
def breaks_once():
    runs["setup"] += 1
    if runs["setup"] == 1:
        raise OSError("not connected")


def test_is_set_up_in_the_second_attempt(breaks_once):
    pass


@pytest.fixture
def breaks_at_the_end():
    yield
    raise OSError("does not stop")


def test_is_never_torn_down(breaks_at_the_end):
    pass


@pytest.mark.flaky(reruns=0)
def test_fails_without_a_rerun():
    assert 0


@pytest.mark.xfail(reason="known")
def test_is_expected_to_fail():
    assert 0


def test_is_skipped():
    pytest.skip("no arm")
