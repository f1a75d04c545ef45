"""All kinds of results of a test."""

import sys
import unittest

import rtf.session


def check(test, value):
    """Fails in a function of the tests."""
    test.assertLess(value, 3)  # line: too large


class ArmTest(unittest.TestCase):
    """Results of test methods."""

    def test_passes(self):  # line: passes
        self.assertEqual(1 + 1, 2)

    def test_fails(self):
        self.assertEqual(41, 42, 'the arm "left" <home> & stays, ü')  # line: fails

    def test_fails_near(self):
        self.assertAlmostEqual(0.5, 0.75, delta=0.1)  # line: fails near

    def test_fails_in_function(self):
        check(self, 7)

    def test_fails_in_list(self):
        self.assertEqual([1, 2], [1, 3])  # line: fails in list

    def test_raises(self):
        raise ValueError("no power, joint 3")  # line: raises

    def test_exits(self):
        sys.exit(0)  # line: exits

    @unittest.skip("not mounted")
    def test_is_skipped(self):
        raise AssertionError

    def test_skips(self):
        self.skipTest("no gripper, <none>")

    @unittest.expectedFailure
    def test_fails_as_expected(self):
        self.fail("known")

    @unittest.expectedFailure  # line: passes unexpectedly
    def test_passes_unexpectedly(self):
        pass

    def test_prints(self):
        print("on stdout")
        print("on stderr", file=sys.stderr)

    def test_measures(self):
        session = rtf.session.current()
        self.assertTrue(session.measure("settling time", 0.3, "s", high=0.8))
        session.report("reported directly")

    def test_subtests(self):
        for joint in range(3):
            with self.subTest("joint", number=joint):
                if joint == 2:
                    self.skipTest("not mounted")
                self.assertNotEqual(joint, 1)  # line: joint 1

    def test_subtests_raise(self):
        with self.subTest(side="left"):
            raise OSError("no answer")  # line: subtest raises


class SetUpTest(unittest.TestCase):
    """The set-up of each test fails."""

    def setUp(self):
        raise OSError("no robot")  # line: no robot

    def test_never(self):
        raise AssertionError


class TearDownTest(unittest.TestCase):
    """The tear-down of each test fails."""

    def tearDown(self):
        raise OSError("the gripper is stuck")  # line: stuck

    def test_passes(self):
        pass

    def test_fails(self):
        self.fail("closed")  # line: closed


class AsyncTest(unittest.IsolatedAsyncioTestCase):
    """Asynchronous tests."""

    async def test_moves(self):
        self.assertIsNotNone(self)


@unittest.skip("no vehicle")
class SkippedTest(unittest.TestCase):
    """A class that is skipped."""

    def test_drives(self):
        raise AssertionError


def load_tests(loader, tests, pattern):
    """Adds a test without a class."""
    tests.addTest(unittest.FunctionTestCase(function_passes))
    return tests


def function_passes():
    """A test that is a function."""
