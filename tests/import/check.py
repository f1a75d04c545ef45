#!/usr/bin/env python3
"""Builds a colcon workspace, imports its tests, and runs the suite.

    check.py RTF DIRECTORY

`colcon` and Debian's ament are installed. The workspace is built in DIRECTORY.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests/frameworks")]

from observed import observe  # noqa: E402
from run import Run  # noqa: E402

EXPECTED = {
    "arm_driver.test_arm": {"Arm.Moves": "passed", "Arm.Fails": "failed"},
    "arm_driver.test_py": {"test_py": "passed"},
    "arm_driver.ctest": {"custom": "passed"},
    "arm_tools": {"test_tools": "passed"},
    "plain_lib.lib_test": {"Lib.A": "passed", "Lib.B": "failed"},
    "plain_lib.ctest": {"smoke": "passed", "with_filter": "passed"},
}
# ament needs the Python for which Debian's packages are installed.
BUILD = ["colcon", "build", "--cmake-args", "-DPython3_EXECUTABLE=/usr/bin/python3"]


def main() -> int:
    """Prints all differences; the exit code is 1 if there is any."""
    rtf, directory = str(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve()
    shutil.rmtree(directory, ignore_errors=True)
    shutil.copytree(Path(__file__).parent / "workspace", directory)
    subprocess.run(BUILD, cwd=directory, check=True)
    suite = directory / "suite.xml"
    printed = run_import(rtf, "colcon", str(directory), "--output", str(suite))
    print(printed)
    differences = compare(rtf, directory, suite, printed)
    again = [rtf, "import", "colcon", str(directory), "--output", str(suite)]
    if subprocess.run(again, check=False).returncode != 2:
        differences.append("a suite was overwritten without --force")
    run_import(rtf, "ctest", str(directory / "build/plain_lib"), "--output", str(suite), "--force")
    if "arm_driver" in suite.read_text():
        differences.append("--force did not overwrite the suite")
    for difference in differences:
        print(f"different: {difference}")
    print(f"{max(len(EXPECTED) - len(differences), 0)} passed, {len(differences)} failed")
    return 1 if differences else 0


def run_import(rtf: str, *arguments: str) -> str:
    """What `rtf import` prints."""
    command = [rtf, "import", *arguments]
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout


def compare(rtf: str, directory: Path, suite: Path, printed: str) -> list[str]:
    """Runs the suite in the environment of the workspace, which rtf prints."""
    set_up, command = printed.splitlines()[-1].removeprefix("next: ").split(" && ")
    if not command.startswith("rtf run "):
        return [f"the next command is `{command}`"]
    show = f"{set_up} >&2 && env -0"
    variables = subprocess.run(["bash", "-c", show], stdout=subprocess.PIPE, text=True, check=True)
    for assignment in filter(None, variables.stdout.split("\0")):
        name, value = assignment.split("=", maxsplit=1)
        os.environ[name] = value
    run = Run(rtf, str(suite), directory / "results")
    run.wait()
    got = {
        name: {path.rsplit("::", 1)[-1]: case.verdict for path, case in test.cases.items()}
        for name, test in observe(run.events()).items()
    }
    names = sorted(got.keys() | EXPECTED.keys())
    return [
        f"{name}: got {got.get(name)}, expected {EXPECTED.get(name)}"
        for name in names
        if got.get(name) != EXPECTED.get(name)
    ]


if __name__ == "__main__":
    sys.exit(main())
