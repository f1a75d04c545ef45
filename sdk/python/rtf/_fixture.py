"""The base class of fixtures."""

from __future__ import annotations

from rtf import _session
from rtf._plugin import Plugin


class Test:
    """An attempt of a test."""

    __test__ = False  # pytest must not collect it

    def __init__(self, number: int, name: str, repetition: int, attempt: int) -> None:
        """Name the attempt."""
        self.id = number
        self.name = name
        self.repetition = repetition
        self.attempt = attempt


class FixtureManager(Plugin):
    """A fixture: it runs while tests run, for example a simulator or a driver.

    The runner calls `setup` before the tests, `check` before each test and
    while tests run, and always `tearDown` at the end. A fixture with `testStarted` or
    `testFinished` is notified of each test.
    """

    def setup(self, args: list[str]) -> bool | None:
        """Start the fixture. `False` or an exception means that it failed."""

    def check(self) -> bool | None:
        """Check the fixture. `False` or an exception means that it collapsed."""

    def testStarted(self, test: Test) -> bool | None:
        """Called before a test starts. `False` or an exception: the fixture collapsed."""

    def testFinished(self, test: Test, verdict: str, reason: str) -> bool | None:
        """Called after a test with its verdict: `passed`, `failed`, `error`, `crashed` and so on.

        Reports, measurements and attachments of this function belong to that test.
        """

    def tearDown(self) -> None:
        """Stop the fixture, also after a failed `setup`."""

    def provide(self, name: str, value: object) -> None:
        """Provide a value for tests, hooks and dependent fixtures: in `setup`, once per name.

        `value` is any value that `json` can encode, except `None`. The others read it with
        `fixture_value`, and from the environment.
        """
        # `python3 -m rtf.host` imports this module while the working directory is searched.
        import json  # noqa: PLC0415

        if value is None:
            raise TypeError(f"the value of `{name}` is None")
        try:
            json.dumps(value, allow_nan=False)
        except (TypeError, ValueError) as problem:
            raise TypeError(f"the value of `{name}` is not JSON: {problem}") from None
        _session.current().provide(name, value)

    def collapsed(self, reason: object) -> None:
        """Report from any thread that the fixture collapsed."""
        _session.current().notify("collapsed", {"reason": str(reason)})
