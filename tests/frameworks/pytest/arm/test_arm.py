"""All kinds of results."""

import logging
import sys
import unittest

import pytest


def test_runs_last():
    pass


def test_passes():  # line: passes
    assert 1 + 1 == 2


def test_fails():
    position = 41
    assert position == 42, 'the arm "left" <home> & stays'  # line: fails


def test_fails_near():
    assert 0.5 == pytest.approx(0.75, abs=0.1)  # line: fails near


def test_fails_in_text():
    assert "a\nb" == "a\nc"  # line: fails in text


def check(value):
    assert value < 3, "too large"


def test_fails_in_function():
    check(7)  # line: calls
    raise AssertionError


def test_has_handled_failure():
    try:
        assert 1 == 2
    except AssertionError:
        pass
    raise ValueError("no power, joint 3 ü")  # line: raises


def test_calls_fail():
    pytest.fail("not today")  # line: calls fail


def test_exits():
    sys.exit(0)  # line: exits


def test_skips():
    pytest.skip("no gripper, <none>")


@pytest.mark.skip(reason="not mounted")
def test_is_skipped():
    raise AssertionError


@pytest.mark.skip
def test_is_skipped_silently():
    raise AssertionError


@pytest.mark.xfail(reason="known problem")
def test_fails_as_expected():
    raise AssertionError("known")


@pytest.mark.xfail
def test_passes_unexpectedly():
    pass


@pytest.mark.xfail(strict=True, reason="must fail")
def test_passes_strictly():
    pass


@pytest.mark.xfail(raises=OSError)
def test_fails_in_another_way():
    raise ValueError("another way")  # line: another way


def test_expects_failure_itself():
    pytest.xfail("no calibration")


def test_has_no_robot(robot):
    raise AssertionError(robot)


def test_has_stuck_gripper(gripper):
    assert gripper


def test_fails_and_is_stuck(gripper):
    assert gripper == "hand"  # line: fails and is stuck


def test_prints():
    print("on stdout")
    print("on stderr", file=sys.stderr)
    logging.getLogger("arm").warning("in the log")


def test_records(record_property):
    record_property("cycles", 12)
    record_property("effort", 2.5)
    record_property("gripper", 'two "fingers"')
    record_property("is_open", True)


def test_measures(rtf):
    assert rtf.measure("settling time", 0.3, "s", high=0.8)
    rtf.sample("position", 0.5, "rad", low=0)
    rtf.report("reported directly")
    rtf.attach(__file__, "source")
    assert rtf.fixture_value("none.port", 7) == 7
    with pytest.raises(LookupError):
        rtf.fixture_value("none.port")


def test_exceeds_limit(rtf):
    assert not rtf.measure("overshoot", 0.3, "rad", high=0.1)  # line: exceeds


@pytest.mark.slow
@pytest.mark.joint(3)
def test_has_tags():
    pass


@pytest.mark.parametrize("speed", [0.25, 2])
@pytest.mark.parametrize("tool", ["hand", 'a/b "c", [d] ü', None])
def test_reaches(speed, tool):
    assert speed < 1, tool  # line: too fast


@pytest.mark.parametrize("axis", [pytest.param(object(), id="x"), int])
def test_axis(axis):
    assert axis


def test_subtests(subtests):
    for joint in range(3):
        with subtests.test("joint", number=joint):
            if joint == 2:
                pytest.skip("not mounted")
            assert joint != 1  # line: joint 1


class TestGripper:
    """A class of tests."""

    def test_opens(self):
        pass


class ArmCase(unittest.TestCase):
    """A class of unittest."""

    def test_moves(self):
        self.assertEqual(1, 2)  # line: unittest


def test_after_all():
    pass
