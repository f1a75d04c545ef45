"""Tests that were written for robot-testing-framework 2.x.

Such a test is a class with the name ``TestCase`` that derives from none of
ours. Its functions are those of the module `robottestingframework`.
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


def lend_module(module: ModuleType, source: bytes) -> None:
    """Give a file that names the predecessor's module this module, imported or not."""
    names = [name for name in _MODULE_NAMES if name.encode() in source]
    if names:
        import robottestingframework  # noqa: PLC0415 - most plug-ins do not need it

        vars(module).update(dict.fromkeys(names, robottestingframework))


def find(module: ModuleType) -> type | None:
    """Return the file's own class ``TestCase``, unless it is one of ours."""
    found = vars(module).get(CLASS_NAME)
    if not isinstance(found, type) or issubclass(found, Plugin):
        return None
    return found if found.__module__ == module.__name__ else None


class PredecessorTest(TestCase):
    """Calls such a test as the predecessor did."""

    def __init__(self, test: Any) -> None:
        """Take the object that the plug-in's class made."""
        self._test = test

    def setup(self, args: list[str]) -> bool | None:
        """Hand over the parameters in one piece; only what is true is a success."""
        del args
        setup = getattr(self._test, "setup", None)
        if setup is None:
            return True
        session = _session.current()
        done = setup(session.task.param)
        if done is None and session.judge.first() is None:
            session.error("setup returned nothing, it has to return true")
        return done or False

    def run(self) -> None:
        """Do the test."""
        # Not dropped: the host looks whether it is a coroutine.
        result: None = self._test.run()
        return result

    def tearDown(self) -> None:
        """Put back what the test changed."""
        tear_down = getattr(self._test, "tearDown", None)
        if tear_down is not None:
            tear_down()
