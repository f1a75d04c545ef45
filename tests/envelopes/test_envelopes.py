"""Limits of robot models, compared with those of MuJoCo."""

from __future__ import annotations

from pathlib import Path

import pytest
from checkout import call, venv


@pytest.mark.parametrize("models", ["icub", "example", "random"])
def test_limits_are_those_of_mujoco(debug_rtf: str, models: str) -> None:
    script = Path(__file__).with_name("mujoco_limits.py")
    call(venv("icub") / "python", script, debug_rtf, models)
