"""A module of the user with the name of the SDK does not replace it."""

from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec
from typing import TYPE_CHECKING

import pytest
from driver import PACKAGE
from session_host import PYTEST, UNITTEST, SessionHost

if TYPE_CHECKING:
    from pathlib import Path

TEST = """import unittest
import arm

class Arm(unittest.TestCase):
    def test_moves(self):
        self.assertEqual(arm.PLACE, "beside the test")
"""


@pytest.fixture(params=["rtf.py", "rtf/__init__.py"])
def project(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A directory of tests with such a module, and with one that they import."""
    module = tmp_path / str(request.param)
    module.parent.mkdir(exist_ok=True)
    module.write_text("raise RuntimeError('the module of the user')\n")
    (tmp_path / "arm.py").write_text("PLACE = 'beside the test'\n")
    (tmp_path / "test_arm.py").write_text(TEST)
    return tmp_path


def cases(host: SessionHost) -> list[str]:
    """The verdicts of the finished cases."""
    finished = [packet for packet in host.packets if packet["method"] == "case-finished"]
    return [packet["params"].get("verdict", "passed") for packet in finished]


@pytest.mark.parametrize("program", [PYTEST, UNITTEST])
def test_tests_of_other_frameworks_run(program: tuple[str, ...], project: Path) -> None:
    host = SessionHost(project, *program, "test_arm.py")
    assert (host.code, cases(host)) == (0, ["passed"]), host.output


@pytest.mark.skipif(find_spec("xdist") is None, reason="pytest-xdist is missing")
def test_workers_of_xdist_run(project: Path) -> None:
    host = SessionHost(project, *PYTEST, "-n", "1", "test_arm.py")
    assert (host.code, cases(host)) == (0, ["passed"]), host.output


def test_plugins_are_checked(project: Path) -> None:
    (project / "Test.py").write_text("import rtf\nclass Test(rtf.TestCase): pass\n")
    command = [sys.executable, "-m", "rtf_start", "rtf.host", "--check", "Test.py"]
    environment = {"PYTHONPATH": str(PACKAGE)}
    checked = subprocess.run(
        command, cwd=project, env=environment, capture_output=True, text=True, check=False
    )
    assert (checked.returncode, checked.stderr) == (0, "")
    assert '"ok": true' in checked.stdout
