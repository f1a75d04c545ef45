from flaky import flaky

runs = []


@flaky
def test_passes_in_the_second_attempt():
    runs.append(1)
    assert len(runs) > 1, "too slow"


@flaky(max_runs=3)
def test_fails_in_all_attempts():
    assert 0


@flaky(max_runs=3, min_passes=2)
def test_passes_twice():
    pass


def test_plain():
    pass
