#!/usr/bin/python3
"""Cases that start processes, see tests/frameworks/descendants."""

import io
import sys
import unittest
from pathlib import Path

import rostest

ROOT = Path(__file__).resolve().parents[4]
sys.path[:0] = [str(ROOT / name) for name in ("sdk/python", "tests/frameworks/descendants/pytest")]

import deeds  # noqa: E402

LEFT_OUT = (
    # Their child continues with the program, and writes into the results of its parent.
    *(deeds.forks_and_exits, deeds.forks_and_returns, deeds.forks_and_fails),
    # `RTF_SESSION` reaches all nodes.
    deeds.has_an_environment_of_its_own,
)


class Inner(unittest.TestCase):
    """Its results are none of this program."""

    def passes(self) -> None:
        """Passes."""

    def fails(self) -> None:
        """Fails."""
        self.fail("inside")


class Descendants(unittest.TestCase):
    """A case for each way to start processes."""

    def test_runs_unittest_in_unittest(self) -> None:
        """The results of the inner run are no cases of this one."""
        inner = unittest.TestSuite([Inner("passes"), Inner("fails")])
        result = unittest.TextTestRunner(io.StringIO()).run(inner)
        self.assertEqual((result.testsRun, len(result.failures)), (2, 1))


def add(name: str) -> None:
    """Adds a case."""

    def test(self: unittest.TestCase) -> None:
        self.assertTrue(deeds.holds(name))

    setattr(Descendants, f"test_{name}", test)


for deed in deeds.DEEDS:
    if deed not in LEFT_OUT:
        add(deed.__name__)


if __name__ == "__main__":
    rostest.rosrun("arm_tests", "descendants", Descendants)
