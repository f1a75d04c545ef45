"""The base class of fixtures."""

from __future__ import annotations

from rtf import _session
from rtf._keeper import Keeper


class Test:
    """An attempt of a test, of which a fixture is told."""

    __test__ = False  # pytest shall not collect what only has the name

    def __init__(self, number: int, name: str, repetition: int, attempt: int) -> None:
        """Name the attempt."""
        self.id = number
        self.name = name
        self.repetition = repetition
        self.attempt = attempt


class FixtureManager(Keeper):
    """A fixture: what has to run while tests do, such as a simulator or a driver.

    The runner calls `setup` before the tests, `check` before each test and
    while tests run, and `tearDown` at the end, whatever happened. One that has
    a `testStarted` or a `testFinished` is told of each test.
    """

    def setup(self, args: list[str]) -> bool | None:
        """Bring the fixture up. `False` or an exception means that it failed."""

    def check(self) -> bool | None:
        """Look whether the fixture is well. `False` or an exception means that it collapsed."""

    def testStarted(self, test: Test) -> bool | None:
        """Hear that a test is about to begin. `False` or an exception: the fixture collapsed."""

    def testFinished(self, test: Test, verdict: str, reason: str) -> bool | None:
        """Hear how a test was judged: `passed`, `failed`, `error`, `crashed`, `timed-out`.

        What the fixture reports, measures and attaches here belongs to that test.
        """

    def tearDown(self) -> None:
        """Bring the fixture down, also after a `setup` that failed."""

    def collapsed(self, reason: object) -> None:
        """Tell at once, from any thread, that the fixture is not well any more."""
        _session.current().notify("collapsed", {"reason": str(reason)})
