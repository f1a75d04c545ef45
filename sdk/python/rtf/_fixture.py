"""The base class of fixtures."""

from __future__ import annotations

from rtf import _session
from rtf._plugin import Plugin


class FixtureManager(Plugin):
    """A fixture: what has to run while tests do, such as a simulator or a driver.

    The runner calls `setup` before the tests, `check` before each test and
    while tests run, and `tearDown` at the end, whatever happened.
    """

    def setup(self, args: list[str]) -> bool | None:
        """Bring the fixture up. `False` or an exception means that it failed."""

    def check(self) -> bool | None:
        """Look whether the fixture is well. `False` or an exception means that it collapsed."""

    def tearDown(self) -> None:
        """Bring the fixture down, also after a `setup` that failed."""

    def collapsed(self, reason: object) -> None:
        """Tell at once, from any thread, that the fixture is not well any more."""
        _session.current().notify("collapsed", {"reason": str(reason)})
