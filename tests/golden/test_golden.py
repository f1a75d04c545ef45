"""Differences of trajectories and pictures, compared with dtaidistance and scikit-image."""

from __future__ import annotations

from pathlib import Path

import pytest
from cargo import example
from checkout import call, venv


@pytest.mark.parametrize(("script", "program"), [("warping", "warp"), ("pictures", "similarity")])
def test_golden(request: pytest.FixtureRequest, script: str, program: str) -> None:
    built = example(request.config, program)
    call(venv("golden") / "python", Path(__file__).with_name(f"{script}.py"), built)
