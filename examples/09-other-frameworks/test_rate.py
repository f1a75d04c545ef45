"""pytest: how often the arm answers in a second."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from rtf.session import Session

sys.path.insert(0, str(Path(__file__).parent.parent / "01-simulated-arm"))

from arm_client import Arm


@pytest.fixture
def arm() -> Iterator[Arm]:
    """A connection to the arm."""
    arm = Arm(int(os.environ["RTF_FIXTURE_ARM_PORT"]))
    yield arm
    arm.close()


@pytest.mark.parametrize("joint", ["shoulder", "elbow", "wrist"])
def test_answers_fast(arm: Arm, joint: str, rtf: Session) -> None:
    """A hundred questions take less than five seconds."""
    started = time.monotonic()
    for _ in range(100):
        arm.position(joint)
    rate = 100 / (time.monotonic() - started)
    assert rtf.measure("rate", rate, "Hz", low=20)


@pytest.mark.skip(reason="the simulated arm has no camera")
def test_camera() -> None:
    """Needs the real robot."""
