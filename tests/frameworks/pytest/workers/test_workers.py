"""Tests that run in workers of pytest-xdist."""

import ctypes
import time

import pytest


@pytest.mark.parametrize("joint", range(4))
def test_moves(joint, rtf):
    rtf.measure("effort", joint, "N")
    rtf.report(f"joint {joint} in a worker")
    time.sleep(joint / 10)
    assert rtf.fixture_value("none.port", 7) == 7


@pytest.mark.slow
def test_fails(record_property):
    record_property("cycles", 7)
    print("captured in a worker")
    assert 1.5 == 2.5  # line: fails in a worker


def test_crashes():
    ctypes.string_at(0)


def test_skips():
    pytest.skip("no gripper")
