#!/usr/bin/env python3
"""Builds and tests a colcon workspace whose packages have suites.

    check.py RTF CMAKE DIRECTORY

`colcon` and Debian's ament are installed. CMAKE contains the CMake package `rtf`. The
workspace is built in DIRECTORY.
"""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
# ament needs the Python for which Debian's packages are installed.
CMAKE_ARGS = ["--cmake-args", "-DPython3_EXECUTABLE=/usr/bin/python3"]

problems: list[str] = []


def check(what: str, got: object, expected: object) -> None:
    """Prints a comparison and keeps a difference."""
    print(f"{'ok' if got == expected else 'DIFFERENT'}: {what}: {got}", flush=True)
    if got != expected:
        problems.append(f"{what}: got {got}, expected {expected}")


class Counts(NamedTuple):
    """What `colcon test-result` counts in a file."""

    tests: int
    errors: int
    failures: int
    skipped: int


class Workspace:
    """A workspace in which `colcon` runs."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self.starts = directory / "starts.txt"

    def colcon(self, *arguments: str, **variables: str) -> tuple[int, str]:
        """The exit code of a command and what it prints."""
        self.starts.write_text("")
        environment = os.environ | {"ARM_STARTS": str(self.starts)} | variables
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


def main() -> int:
    """Prints all differences; the exit code is 1 if there is any."""
    rtf, cmake, directory = (Path(argument).resolve() for argument in sys.argv[1:4])
    shutil.rmtree(directory, ignore_errors=True)
    shutil.copytree(Path(__file__).parent / "workspace", directory)
    (directory / "src/ament_cmake_rtf").symlink_to(ROOT / "packaging/ament/ament_cmake_rtf")
    os.environ |= {"rtf_DIR": str(cmake), "PATH": f"{rtf.parent}:{os.environ['PATH']}"}
    workspace = Workspace(directory)
    check("build", workspace.colcon("build", *CMAKE_ARGS)[0], 0)
    check_green(workspace)
    check_red(workspace)
    check_killed(workspace)
    check_import(str(rtf), directory)
    for problem in problems:
        print(f"different: {problem}")
    return 1 if problems else 0


def check_green(workspace: Workspace) -> None:
    """All suites pass, and fixtures start once for each run of a suite."""
    check("test", workspace.test(), 0)
    check("starts of the fixture", workspace.fixture_starts(), 3)
    code, files = workspace.results()
    check("test-result", code, 0)
    check("results of arm", files.get("arm.xunit"), Counts(3, 0, 0, 0))
    check("results of each", files.get("each.xunit"), Counts(3, 0, 0, 0))
    check("results of CTest", files.get("Test"), Counts(6, 0, 0, 0))
    check("results of arm_sim", files.get("pytest"), Counts(1, 0, 0, 0))


def check_red(workspace: Workspace) -> None:
    """A test that fails, one that crashes, and one that skips itself."""
    variables = {"ARM_MOVE": "fail", "ARM_GRIP": "crash", "ARM_TOUCH": "skip"}
    only = ["--packages-select", "arm_driver"]
    check("red test", workspace.test(*only, **variables), 1)
    code, files = workspace.results()
    check("red test-result", code, 1)
    check("red results of arm", files.get("arm.xunit"), Counts(3, 1, 1, 1))
    check("red results of each", files.get("each.xunit"), Counts(3, 1, 1, 1))
    # `arm`, `each/Move` and `each/Grip`
    check("red results of CTest", files.get("Test"), Counts(6, 0, 3, 1))
    check("test after red", workspace.test(*only), 0)


def check_killed(workspace: Workspace) -> None:
    """The runner and its guard are killed: the results of the run before do not remain."""
    check("killed", workspace.test("--packages-select", "arm_driver", ARM_GRIP="kill"), 1)
    # Nothing is left that could stop them.
    workspace.end_fixtures()
    code, files = workspace.results()
    check("test-result of the killed run", code, 1)
    for name in ("arm", "each"):
        check(f"killed results of {name}", files.get(f"{name}.xunit"), Counts(1, 1, 0, 0))


def check_import(rtf: str, directory: Path) -> None:
    """`rtf import colcon` prints how to run the suites of the packages."""
    command = [rtf, "import", "colcon", str(directory), "--output", str(directory / "suite.xml")]
    printed = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
    print(printed)
    lines = [line for line in printed.splitlines() if line.startswith("next: ")]
    suites = [line for line in lines if not line.endswith("suite.xml")]
    check("suites to run next", len(suites), 2)
    for line in suites:
        next_command = f"cd {directory} && {line.removeprefix('next: ')}"
        variables = os.environ | {"ARM_LIST": "ab"}
        ran = subprocess.run(["bash", "-c", next_command], env=variables, check=False)
        check(line, ran.returncode, 0)


if __name__ == "__main__":
    sys.exit(main())
