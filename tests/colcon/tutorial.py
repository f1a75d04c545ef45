#!/usr/bin/env python3
"""Follows docs/tutorials/ros2-workspace.md literally, in an empty directory.

    tutorial.py PREFIX DIRECTORY

`rtf` is installed in PREFIX; `colcon`, Debian's ament and a Python with `rclpy` are on PATH.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
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


def main() -> int:
    """Prints the commands and what they print; the exit code is 1 if that is not expected."""
    prefix, directory = (Path(argument).resolve() for argument in sys.argv[1:3])
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    environment = os.environ | {
        "PATH": f"{prefix}/bin:{os.environ['PATH']}",
        "CMAKE_PREFIX_PATH": str(prefix),
        # ament needs the Python for which Debian's packages are installed.
        "Python3_ROOT": "/usr",
    }
    started = time.monotonic()
    printed = follow(directory, environment)
    print(f"the commands took {time.monotonic() - started:.0f} s")
    position = 0
    for text in EXPECTED:
        found = re.compile(text).search(printed, position)
        if not found:
            print(f"different: `{text}` is not printed after the text before")
            return 1
        position = found.end()
    return 0


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
    if ran.returncode:
        raise SystemExit(f"different: a command of {PAGE.name} ended with {ran.returncode}")
    return ran.stdout


if __name__ == "__main__":
    sys.exit(main())
