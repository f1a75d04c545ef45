"""Tests that end or block the process."""

import ctypes
import os
import sys
import time


def test_before():
    pass


def test_crashes():  # line: crashes
    ctypes.string_at(0)


def test_after_crash():
    pass


def test_exits_with_success():
    os._exit(0)


def test_exits():
    os._exit(3)


def test_hangs():
    while True:
        wait_for_arm()


def wait_for_arm():
    time.sleep(1000)


def test_after_hang():
    assert sys.argv == []  # line: after the hang


def test_last():
    pass
