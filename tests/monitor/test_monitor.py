"""Robustness of random formulas, compared with rtamt and with a second implementation."""

from __future__ import annotations

from pathlib import Path

import pytest
from cargo import example
from checkout import call, venv


@pytest.fixture(scope="module")
def program(request: pytest.FixtureRequest) -> str:
    """The example that judges formulas."""
    return example(request.config, "robustness")


@pytest.mark.parametrize("judge", ["reference", "dense", "discrete"])
def test_robustness_of_random_formulas(program: str, judge: str) -> None:
    python = venv("monitor", PIP_NO_DEPS="1") / "python"
    call(python, Path(__file__).with_name("compare_robustness.py"), program, judge)
