"""Tests that end or block the process."""

import ctypes
import os
import time
import unittest


class BrokenTest(unittest.TestCase):
    """Runs in the order of the names."""

    def test_1_before(self):
        print("before the crash")

    def test_2_crashes(self):  # line: crashes
        ctypes.string_at(0)

    def test_3_after_crash(self):
        pass

    def test_4_exits_with_success(self):
        os._exit(0)

    def test_5_exits(self):
        os._exit(3)

    def test_6_hangs(self):
        while True:
            wait_for_arm()

    def test_7_after_hang(self):
        self.assertEqual(1.5, 2.5)  # line: after the hang

    def test_8_last(self):
        pass


def wait_for_arm():
    """Waits for too long."""
    time.sleep(1000)
