import pytest

IDS = [
    "a::b",
    "a/b",
    "[x]",
    "two words",
    "ümläut",
    "tab\there",
    "",
    "a",
    "a",
    "%41",
    "#2",
    "a#2",
    "-n",
    "*?",
    "'quoted'",
    "x" * 300,
]


@pytest.mark.parametrize("value", range(len(IDS)), ids=IDS)
def test_id(value):
    assert value != 3


@pytest.mark.parametrize("value", [b"\x00\xff", 1e300, None, object, ..., -0.0, "\n", "\\"])
def test_value(value):
    assert value is not None


@pytest.mark.parametrize("a", ["x", "y"])
@pytest.mark.parametrize("b", ["::", "]["])
def test_two(a, b):
    assert (a, b) != ("y", "::")
