"""Builds and tests a colcon workspace whose packages have suites."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import signal
import subprocess
from pathlib import Path
from typing import NamedTuple

import pytest
from checkout import ROOT, need_packages, venv
from run import expect

pytestmark = pytest.mark.first
# ament needs the Python for which Debian's packages are installed.
CMAKE_ARGS = ["--cmake-args", "-DPython3_EXECUTABLE=/usr/bin/python3"]


class Counts(NamedTuple):
    """What `colcon test-result` counts in a file."""

    tests: int
    errors: int
    failures: int
    skipped: int


class Workspace:
    """A workspace in which `colcon` runs."""

    def __init__(self, directory: Path, environment: dict[str, str]) -> None:
        self.directory, self.environment = directory, environment
        self.starts = directory / "starts.txt"

    def colcon(self, *arguments: str, **variables: str) -> tuple[int, str]:
        """The exit code of a command and what it prints."""
        self.starts.write_text("")
        environment = self.environment | {"ARM_STARTS": str(self.starts)} | variables
        ran = subprocess.run(
            ["colcon", "--log-level", "error", *arguments],
            cwd=self.directory,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        print(f"$ colcon {' '.join(arguments)} {variables}\n{ran.stdout}", flush=True)
        return ran.returncode, ran.stdout

    def test(self, *arguments: str, **variables: str) -> int:
        """Tests the packages."""
        return self.colcon("test", "--return-code-on-test-failure", *arguments, **variables)[0]

    def results(self) -> tuple[int, dict[str, Counts]]:
        """The exit code of `colcon test-result`, and what it counts in each file."""
        code, printed = self.colcon("test-result", "--all")
        lines = [line.split(".xml: ") for line in printed.splitlines() if ".xml: " in line]
        numbers = [(Path(file).name, re.findall(r"\d+", counts)) for file, counts in lines]
        return code, {name: Counts(*map(int, found)) for name, found in numbers}

    def fixture_starts(self) -> int:
        """How often the fixture was started by the last command."""
        return len(self.starts.read_text().splitlines())

    def end_fixtures(self) -> None:
        """End the fixtures that the last command has left."""
        for process in self.starts.read_text().split():
            with contextlib.suppress(ProcessLookupError):
                os.kill(int(process), signal.SIGTERM)


@pytest.fixture(scope="module")
def workspace(rtf: str, tmp_path_factory: pytest.TempPathFactory) -> Workspace:
    """The workspace, which is built."""
    need_packages("ament-cmake", "cmake", "g++")
    directory = tmp_path_factory.mktemp("colcon") / "workspace"
    shutil.copytree(Path(__file__).parent / "workspace", directory)
    (directory / "src/ament_cmake_rtf").symlink_to(ROOT / "packaging/ament/ament_cmake_rtf")
    colcon = venv("colcon")
    environment = {name: it for name, it in os.environ.items() if not name.startswith("PYTEST_")}
    environment |= {
        "rtf_DIR": f"{ROOT}/sdk/cpp/cmake/rtf",
        "RTF_PYTHON": str(colcon / "python"),
        "PATH": f"{Path(rtf).parent}:{colcon}:{os.environ['PATH']}",
    }
    workspace = Workspace(directory, environment)
    expect("build", workspace.colcon("build", *CMAKE_ARGS)[0], 0)
    return workspace


def test_suites_are_tests_of_packages_and_fixtures_start_once_for_each_run(
    workspace: Workspace,
) -> None:
    """All suites pass, and fixtures start once for each run of a suite."""
    expect("test", workspace.test(), 0)
    expect("starts of the fixture", workspace.fixture_starts(), 3)
    code, files = workspace.results()
    expect("test-result", code, 0)
    expect("results of arm", files.get("arm.xunit"), Counts(3, 0, 0, 0))
    expect("results of each", files.get("each.xunit"), Counts(3, 0, 0, 0))
    expect("results of CTest", files.get("Test"), Counts(6, 0, 0, 0))
    expect("results of arm_sim", files.get("pytest"), Counts(1, 0, 0, 0))


def test_results_are_counted_by_colcon(workspace: Workspace) -> None:
    """A test that fails, one that crashes, and one that skips itself."""
    variables = {"ARM_MOVE": "fail", "ARM_GRIP": "crash", "ARM_TOUCH": "skip"}
    only = ["--packages-select", "arm_driver"]
    expect("red test", workspace.test(*only, **variables), 1)
    code, files = workspace.results()
    expect("red test-result", code, 1)
    expect("red results of arm", files.get("arm.xunit"), Counts(3, 1, 1, 1))
    expect("red results of each", files.get("each.xunit"), Counts(3, 1, 1, 1))
    # `arm`, `each/Move` and `each/Grip`
    expect("red results of CTest", files.get("Test"), Counts(6, 0, 3, 1))
    expect("test after red", workspace.test(*only), 0)


def test_results_of_an_earlier_run_do_not_remain_if_the_runner_is_killed(
    workspace: Workspace,
) -> None:
    """The runner and its guard are killed: the results of the run before do not remain."""
    workspace.test("--packages-select", "arm_driver")
    expect("killed", workspace.test("--packages-select", "arm_driver", ARM_GRIP="kill"), 1)
    # Nothing is left that could stop them.
    workspace.end_fixtures()
    code, files = workspace.results()
    expect("test-result of the killed run", code, 1)
    for name in ("arm", "each"):
        expect(f"killed results of {name}", files.get(f"{name}.xunit"), Counts(1, 1, 0, 0))


def test_import_prints_how_to_run_the_suites_of_packages(rtf: str, workspace: Workspace) -> None:
    directory = workspace.directory
    command = [rtf, "import", "colcon", str(directory), "--output", str(directory / "suite.xml")]
    printed = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
    print(printed)
    lines = [line for line in printed.splitlines() if line.startswith("next: ")]
    suites = [line for line in lines if not line.endswith("suite.xml")]
    expect("suites to run next", len(suites), 2)
    for line in suites:
        next_command = f"cd {directory} && {line.removeprefix('next: ')}"
        variables = workspace.environment | {"ARM_LIST": "ab"}
        ran = subprocess.run(["bash", "-c", next_command], env=variables, check=False)
        expect(line, ran.returncode, 0)
