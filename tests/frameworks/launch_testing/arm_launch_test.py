"""Tests with all kinds of results, on a motor that runs and a homing that ends."""

import sys
import tempfile
import unittest
from pathlib import Path

import launch
import launch_testing
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration
from launch_testing.actions import ReadyToTest
from launch_testing.asserts import assertExitCodes

MOTOR = """
import signal, sys, time
signal.signal(signal.SIGINT, lambda *_: sys.exit("motor parks"))
print("motor", sys.argv[1], "is on", flush=True)
time.sleep(1000)
"""

HOMING = """
trap 'exit 3' INT
until [ -e "$1" ]; do sleep 0.05; done
echo no encoder >&2
exit 3
"""


def generate_test_description():
    """Starts both."""
    motor = ExecuteProcess(cmd=[sys.executable, "-c", MOTOR, LaunchConfiguration("side")])
    directory = tempfile.TemporaryDirectory()
    end = Path(directory.name) / "end"
    homing = ExecuteProcess(cmd=["sh", "-c", HOMING, "sh", str(end)])
    argument = DeclareLaunchArgument("side", default_value="left")
    description = launch.LaunchDescription([argument, motor, homing, ReadyToTest()])
    return description, {"motor": motor, "homing": homing, "end": end, "directory": directory}


class TestArm(unittest.TestCase):
    """The processes run."""

    def test_1_motor_is_on(self, proc_output):  # line: motor is on
        """Passes."""
        proc_output.assertWaitFor("motor right is on", timeout=10, stream="stdout")

    def test_2_homing_ends(self, proc_info, homing, end):
        """Passes, although a process ends with an error."""
        end.touch()
        proc_info.assertWaitForShutdown(process=homing, timeout=10)
        self.assertEqual(proc_info[homing].returncode, 3)

    def test_3_fails(self):
        """Fails."""
        self.assertEqual(41, 42, "the arm is too short")  # line: fails

    def test_4_has_an_error(self):
        """Has an error."""
        raise OSError("the bus is off")  # line: has an error

    def test_5_is_skipped(self):
        """Is skipped."""
        self.skipTest("no gripper")

    @unittest.expectedFailure
    def test_6_fails_as_expected(self):
        """Fails, which is known."""
        self.fail("known")

    def test_7_joints(self):
        """One of two subtests fails."""
        for joint in (1, 2):
            with self.subTest(joint=joint):
                self.assertLess(joint, 2)


class TestBrokenSetUp(unittest.TestCase):
    """Cannot be set up."""

    @classmethod
    def setUpClass(cls):
        """Fails."""
        raise OSError("no bench")  # line: no bench

    def test_first(self):
        """Does not run."""

    def test_second(self):
        """Does not run."""


@launch_testing.post_shutdown_test()
class TestEnd(unittest.TestCase):
    """The processes have ended."""

    def test_exit_codes(self, proc_info):
        """Fails: the motor exits with 1."""
        assertExitCodes(proc_info, allowable_exit_codes=[0, 3])

    def test_homing(self, proc_info, homing):
        """Passes."""
        self.assertEqual(proc_info[homing].returncode, 3)
