"""Cases of pytest that start processes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import deeds
import pytest

INNER = """
def test_inner_passes(): pass
def test_inner_fails(): assert False
"""


@pytest.mark.parametrize("name", [deed.__name__ for deed in deeds.DEEDS])
def test_deed(name: str) -> None:
    """Each has its own way to start processes."""
    assert deeds.holds(name)


def test_runs_pytest_in_pytest(tmp_path: Path) -> None:
    """The results of the inner run are no cases of this one."""
    file = tmp_path / "test_inner.py"
    file.write_text(INNER)
    assert pytest.main(["-q", "-p", "no:cacheprovider", str(file)]) == 1


def test_runs_pytest_in_a_process(tmp_path: Path) -> None:
    """The same in another process."""
    file = tmp_path / "test_inner.py"
    file.write_text(INNER)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(file)]
    assert subprocess.run(command, check=False, stdout=subprocess.PIPE).returncode == 1
