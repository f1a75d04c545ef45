import pytest
from pytest_bdd import given, parsers, scenarios, then, when

scenarios("arm.feature")


@pytest.fixture
def place():
    return {}


@given("an arm", target_fixture="arm")
def arm():
    return {"at": 0}


@when(parsers.parse("it moves to {position:d}"))
def moves(arm, position):
    arm["at"] = position


@then(parsers.parse("it is at {position:d}"))
def is_at(arm, position):
    assert arm["at"] == position
