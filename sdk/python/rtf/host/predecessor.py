"""Runs tests that were written for robot-testing-framework 2.x.

Such a test is a class named ``TestCase`` that derives from no class of the SDK. It calls
the functions of the module `robottestingframework`.
"""

from __future__ import annotations

from rtf import _session
from rtf._plugin import Plugin
from rtf._test import TestCase

# As `typing.TYPE_CHECKING`, without the time that its import takes.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any

CLASS_NAME = "TestCase"

# The module had the second name before version 2.
_MODULE_NAMES = ("robottestingframework", "RTF")


def add_module(module: ModuleType, source: bytes) -> None:
    """Add the predecessor's module to a file that names it, even without an import."""
    names = [name for name in _MODULE_NAMES if name.encode() in source]
    if names:
        import robottestingframework  # noqa: PLC0415 - most plug-ins do not need it

        vars(module).update(dict.fromkeys(names, robottestingframework))


def find(module: ModuleType) -> type | None:
    """Return the file's class ``TestCase``, unless it derives from a class of the SDK."""
    found = vars(module).get(CLASS_NAME)
    if not isinstance(found, type) or issubclass(found, Plugin):
        return None
    return found if found.__module__ == module.__name__ else None


class PredecessorTest(TestCase):
    """Calls such a test like the predecessor."""

    def __init__(self, test: Any) -> None:
        """Wrap an object of the plug-in's class."""
        self._test = test

    def setup(self, args: list[str]) -> bool | None:
        """Pass the parameters as one string; only a true result is a success."""
        del args
        setup = getattr(self._test, "setup", None)
        if setup is None:
            return True
        session = _session.current()
        done = setup(session.task.param)
        if done is None and session.request.has_passed():
            session.error("setup returned nothing, it has to return true")
        return done or False

    def run(self) -> None:
        """Run the test."""
        # Returned, because the host checks that it is no coroutine.
        result: None = self._test.run()
        return result

    def tearDown(self) -> None:
        """Restore the initial state."""
        tear_down = getattr(self._test, "tearDown", None)
        if tear_down is not None:
            tear_down()
