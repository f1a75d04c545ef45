"""Cases of unittest that start processes."""

from __future__ import annotations

import io
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "pytest"))

import deeds


class Inner(unittest.TestCase):
    """Is run by a case of the other class."""

    def inner(self) -> None:
        """Fail."""
        self.fail("inside")


class Descendants(unittest.TestCase):
    """Each case has its own way to start processes."""

    def test_runs_unittest_in_unittest(self) -> None:
        """The results of the inner run are no cases of this one."""
        runner = unittest.TextTestRunner(stream=io.StringIO())
        self.assertFalse(runner.run(Inner("inner")).wasSuccessful())


def _add(name: str) -> None:
    def test(self: Descendants) -> None:
        self.assertTrue(deeds.holds(name))

    setattr(Descendants, f"test_{name}", test)


for _deed in deeds.DEEDS:
    _add(_deed.__name__)
