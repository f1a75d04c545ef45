"""The data that the unit tests of campaigns compare with: still those of other programs."""

from __future__ import annotations

from pathlib import Path

from checkout import ROOT, call, venv

HERE = Path(__file__).parent
STORED = HERE / "scipy.json"


def test_results_are_those_of_scipy() -> None:
    call(python(), HERE / "oracle.py", "--check", STORED)


def test_episodes_are_those_of_a_second_implementation() -> None:
    campaigns = (ROOT / "crates/rtf-campaign/tests/campaign/golden").glob("*.xml")
    call(python(), HERE / "episodes.py", "--check", *sorted(campaigns))


def test_confidence_sequences_are_those_of_savvi() -> None:
    call(venv("sequential") / "python", HERE / "sequential.py", STORED)


def python() -> Path:
    """The interpreter with SciPy; without dependencies, see tools/requirements-history.txt."""
    return venv("history", PIP_NO_DEPS="1") / "python"
