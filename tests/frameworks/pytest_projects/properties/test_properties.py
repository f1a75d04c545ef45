from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

calm = settings(
    max_examples=20, deadline=None, database=None, suppress_health_check=list(HealthCheck)
)


@calm
@given(st.integers())
def test_holds(number):
    assert number - number == 0


@calm
@given(st.lists(st.integers()))
def test_does_not_hold(numbers):
    assert len(numbers) < 2


class TestState:
    @calm
    @given(text=st.text())
    def test_in_class(self, text):
        assert text + "" == text
