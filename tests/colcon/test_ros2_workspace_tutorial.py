"""Follows docs/tutorials/ros2-workspace.md literally, in an empty directory."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest
from checkout import ROOT, call, need_packages, venv

PAGE = ROOT / "docs/tutorials/ros2-workspace.md"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.M | re.S)
FILE = re.compile(r"(?:#|<!--) (\S+\.\w+)(?: -->)?\n")
# What the commands of the page print, in this order.
EXPECTED = [
    "rclpy is there",
    "Finished <<< odometer",
    "passed .* odometer/DistanceTest",
    "odometer.xunit.xml: 1 test, 0 errors, 0 failures",
    "a test failed",
    "got 0.02, expected 0.01",
    "and here is why",
    "odometer/DistanceTest  failed",
    "the run is red",
    "PASSED  1 test in 1 suite",
]


@pytest.mark.first
@pytest.mark.middleware("ros2")
@pytest.mark.usefixtures("rtf")
def test_the_commands_of_the_tutorial_print_what_it_shows(tmp_path: Path) -> None:
    need_packages("ament-cmake", "cmake", "g++")
    prefix, programs, workspace = (tmp_path / name for name in ("prefix", "bin", "workspace"))
    call("tools/install.sh", PREFIX=str(prefix), DESTDIR="")
    # Python is that of rclpy; colcon has its own.
    programs.mkdir()
    (programs / "colcon").symlink_to(venv("colcon") / "colcon")
    workspace.mkdir()
    environment = {name: it for name, it in os.environ.items() if not name.startswith("PYTEST_")}
    environment |= {
        "PATH": f"{prefix}/bin:{programs}:{os.environ['PATH']}",
        "CMAKE_PREFIX_PATH": str(prefix),
        # ament needs the Python for which Debian's packages are installed.
        "Python3_ROOT": "/usr",
    }
    printed = follow(workspace, environment)
    position = 0
    for text in EXPECTED:
        found = re.compile(text).search(printed, position)
        assert found, f"`{text}` is not printed after the text before"
        position = found.end()


def follow(directory: Path, environment: dict[str, str]) -> str:
    """Writes the files and runs the commands of the page, in one shell, as a reader does."""
    script = ["set -ex\n"]
    for language, text in BLOCK.findall(PAGE.read_text()):
        named = FILE.match(text)
        if named:
            # Files are relative to the workspace, in which the shell is by then.
            script.append(f"cat >{named[1]} <<'END_OF_FILE'\n{text}END_OF_FILE\n")
        elif language == "sh":
            script.append(text)
    ran = subprocess.run(
        ["bash", "-c", "".join(script)],
        cwd=directory,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    print(ran.stdout)
    assert ran.returncode == 0, f"exit code {ran.returncode} of a command of {PAGE.name}"
    return ran.stdout
