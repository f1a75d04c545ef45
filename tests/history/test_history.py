"""The change points of the history, compared with Apache Otava's and with planted changes."""

from __future__ import annotations

from pathlib import Path

import pytest
from cargo import example
from checkout import ROOT, call, venv


@pytest.mark.parametrize("expected", ["otava", "planted"])
def test_change_points(request: pytest.FixtureRequest, expected: str) -> None:
    """Without the dependencies of the packages: see tools/requirements-history.txt."""
    python = venv("history", PIP_NO_DEPS="1") / "python"
    program = example(request.config, "change_points")
    script = Path(__file__).with_name("change_points.py")
    call(python, script, program, expected, PYTHONPATH=str(ROOT / "tests/harness"))
