"""Gets arguments."""


def test_gets_the_arguments(request):
    assert request.config.getoption("--launch-args") == ["x:=y"]
