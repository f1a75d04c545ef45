"""Runs the suite of this package in `colcon test`."""

import subprocess
from pathlib import Path


def test_arm_sim() -> None:
    """The suite is green."""
    suite = Path(__file__).with_name("arm_sim.xml")
    subprocess.run(["rtf", "run", str(suite)], check=True)
