"""Builds a colcon workspace, imports its tests, and runs the suite."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from checkout import ROOT, call, need_packages, venv
from observed import observe
from run import Run

pytestmark = [pytest.mark.first, pytest.mark.venv("colcon")]
EXPECTED = {
    "arm_driver.test_arm": {"Arm.Moves": "passed", "Arm.Fails": "failed"},
    "arm_driver.test_py": {"test_py": "passed"},
    "arm_driver.test_driver_launch_test.py": {"TestDriver.test_is_on": "passed"},
    "arm_driver.ctest": {"custom": "passed"},
    "arm_tools": {"test_tools": "passed"},
    "plain_lib.lib_test": {"Lib.A": "passed", "Lib.B": "failed"},
    "plain_lib.ctest": {"smoke": "passed", "with_filter": "passed"},
}
# ament needs the Python for which Debian's packages are installed.
BUILD = ["colcon", "build", "--cmake-args", "-DPython3_EXECUTABLE=/usr/bin/python3"]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The workspace, which no test changes."""
    packages = ["ament-cmake", "ament-cmake-googletest", "ament-cmake-pytest", "libgtest-dev"]
    need_packages(*packages, "cmake", "g++")
    directory = tmp_path_factory.mktemp("workspace") / "workspace"
    shutil.copytree(Path(__file__).parent / "workspace", directory)
    call(*BUILD, cwd=directory, PATH=f"{venv('colcon')}:{os.environ['PATH']}")
    return directory


def test_the_suite_of_a_workspace_runs_its_tests(
    rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, built: Path
) -> None:
    monkeypatch.setenv("RTF_PYTHON", str(venv("colcon") / "python"))
    suite = tmp_path / "suite.xml"
    printed = run_import(rtf, "colcon", str(built), "--output", str(suite))
    set_up, command = printed.splitlines()[-1].removeprefix("next: ").split(" && ")
    assert command.startswith("rtf run ")
    show = f"{set_up} >&2 && env -0"
    variables = subprocess.run(["bash", "-c", show], stdout=subprocess.PIPE, text=True, check=True)
    for assignment in filter(None, variables.stdout.split("\0")):
        name, value = assignment.split("=", maxsplit=1)
        monkeypatch.setenv(name, value)
    # launch is in no registry.
    packages = str(ROOT / "tests/frameworks/launch_testing/packages")
    monkeypatch.setenv("PYTHONPATH", packages, prepend=":")
    run = Run(rtf, str(suite), tmp_path / "results")
    run.wait()
    got = {
        name: {path.rsplit("::", 1)[-1]: case.verdict for path, case in test.cases.items()}
        for name, test in observe(run.events()).items()
    }
    assert got == EXPECTED


def test_a_suite_is_only_overwritten_with_force(rtf: str, tmp_path: Path, built: Path) -> None:
    suite = tmp_path / "suite.xml"
    run_import(rtf, "colcon", str(built), "--output", str(suite))
    again = [rtf, "import", "colcon", str(built), "--output", str(suite)]
    assert subprocess.run(again, check=False).returncode == 2
    run_import(rtf, "ctest", str(built / "build/plain_lib"), "--output", str(suite), "--force")
    assert "arm_driver" not in suite.read_text()


def run_import(rtf: str, *arguments: str) -> str:
    """What `rtf import` prints."""
    command = [rtf, "import", *arguments]
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
