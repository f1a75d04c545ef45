import pytest


@pytest.fixture(params=["simulated", "real"])
def robot(request):
    if request.param == "real":
        pytest.skip("no robot")
    return request.param


@pytest.fixture(scope="module", autouse=True)
def breaks_at_the_end():
    yield
    raise RuntimeError("the server does not stop")
