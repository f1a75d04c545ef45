"""The parameters of a plug-in."""

from __future__ import annotations


class Task:
    """The parameters of `run-test` or `set-up-fixture`."""

    def __init__(self, params: dict[str, object]) -> None:
        """Read them; a `TypeError` names the one that is wrong."""
        self.file = _text_of(params, "file")
        self.name = _text_of(params, "name")
        self.param = _text_of(params, "param", "")
        self.environment = _text_of(params, "environment", "")
        args = params.get("args", [])
        repetition = params.get("repetition", 0)
        if not isinstance(args, list) or not all(isinstance(arg, str) for arg in args):
            raise TypeError("`args` is not a list of texts")
        if not isinstance(repetition, int):
            raise TypeError("`repetition` is not a whole number")
        self.args: list[str] = args
        self.repetition = repetition
        self.last = params.get("is_last", False) is True
        self.attachments_dir = _text_of(params, "attachments_dir", "")
        # Ends the test's output in a host that continues with the next test.
        self.end_marker = _text_of(params, "end_marker", "")
        self.continues_after_failure = params.get("continues_after_failure", False) is True
        # Variables of the environment, which such a host sets before the test.
        self.variables = _texts_of(params, "variables")
        self.parameters = _texts_of(params, "parameters")
        values = _objects_of(params, "fixture_values")
        self.fixture_values = {_text_of(one, "name"): _value_of(one, "value") for one in values}
        self.selectors = [Selector(one) for one in _objects_of(params, "cases")]
        slots = params.get("episodes")
        self.episodes = None if slots is None else EpisodeSlots(slots)

    def selects(self, path: str) -> bool:
        """Whether the case with this path runs."""
        return not self.selectors or any(one.selects(path) for one in self.selectors)


class EpisodeSlots:
    """How an episode test runs its episodes."""

    def __init__(self, params: object) -> None:
        """Read `{"slots": 64, "max_steps": 500, "max_time_us": 20000000}`."""
        numbers = params if isinstance(params, dict) else {}
        slots = _number_of(numbers, "slots")
        if slots is None:
            raise TypeError("`episodes` has no `slots`")
        self.slots = slots
        # The limits of an episode, in steps and in seconds of simulated time.
        self.max_steps = _number_of(numbers, "max_steps")
        micros = _number_of(numbers, "max_time_us")
        self.max_time = None if micros is None else micros / 1e6


class Selector:
    """Selects cases by their path: names joined with `/`."""

    def __init__(self, params: dict[str, object]) -> None:
        """Read `{"equals": PATH}` or `{"contains": TEXT}`."""
        self._is_exact = "equals" in params
        self._text = _text_of(params, "equals" if self._is_exact else "contains")

    def selects(self, path: str) -> bool:
        """Whether the case with this path runs."""
        if self._is_exact:
            return _is_in(path, self._text) or _is_in(self._text, path)
        return self._text in path


def _is_in(path: str, outer: str) -> bool:
    """Whether a case is another one, or in it."""
    return path == outer or path.startswith(f"{outer}/")


def _objects_of(params: dict[str, object], name: str) -> list[dict[str, object]]:
    value = params.get(name, [])
    if not isinstance(value, list) or not all(isinstance(one, dict) for one in value):
        raise TypeError(f"`{name}` is not a list of objects")
    return value


def _texts_of(params: dict[str, object], name: str) -> dict[str, str]:
    return {_text_of(one, "name"): _text_of(one, "value") for one in _objects_of(params, name)}


def _number_of(params: dict[str, object], name: str) -> int | None:
    value = params.get(name)
    if value is not None and (not isinstance(value, int) or value < 1):
        raise TypeError(f"`{name}` of `episodes` is not a number from 1")
    return value


def _value_of(params: dict[str, object], name: str) -> object:
    value = params.get(name)
    if value is None:
        raise TypeError(f"`{name}` is missing or null")
    return value


def _text_of(params: dict[str, object], name: str, default: str | None = None) -> str:
    value = params.get(name, default)
    if not isinstance(value, str):
        raise TypeError(f"`{name}` is missing or not a text")
    return value
