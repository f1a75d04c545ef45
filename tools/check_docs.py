#!/usr/bin/env python3
"""Runs what the user's guide shows: every file in it, every suite.

    check_docs.py RTF PAGE…

A code block whose first line is a comment with a file name is that file. All
files of a page go into one folder; its C++ plug-ins are built, and its suites
must pass.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from pages import write_files

TOP = Path(__file__).resolve().parent.parent

CMAKE_HEADER = """\
cmake_minimum_required(VERSION 3.16)
project(Page LANGUAGES CXX)
find_package(RobotTestingFramework REQUIRED)
"""


def main() -> None:
    """Checks each page."""
    rtf = Path(sys.argv[1]).resolve()
    for page in map(Path, sys.argv[2:]):
        with tempfile.TemporaryDirectory() as folder:
            check(rtf, page, Path(folder))


def check(rtf: Path, page: Path, folder: Path) -> None:
    """Builds and runs what one page shows."""
    suites = write_files(page, folder)
    build(folder)
    for suite in suites:
        print(f"{page}: {suite.name}", flush=True)
        call(folder, str(rtf), "run", suite.name)


def build(folder: Path) -> None:
    """Builds the page's Ada plug-ins, and its C++ ones by its own or the obvious CMakeLists.txt."""
    for project in sorted(folder.glob("*.gpr")):
        call(folder, "gprbuild", "-p", "-q", "-P", project.name)
    sources = sorted(folder.glob("*.cpp"))
    if not sources:
        return
    cmake = folder / "CMakeLists.txt"
    if not cmake.exists():
        plugins = [
            f"robottestingframework_add_plugin({source.stem} SOURCES {source.name})\n"
            for source in sources
        ]
        cmake.write_text(CMAKE_HEADER + "".join(plugins))
    package = TOP / "sdk" / "cpp" / "cmake" / "RobotTestingFramework"
    call(folder, "cmake", "-S", ".", "-B", "build", f"-DRobotTestingFramework_DIR={package}")
    call(folder, "cmake", "--build", "build")


def call(folder: Path, *command: str) -> None:
    """Runs a command that must succeed."""
    environment = os.environ | {
        "RTF_PLUGIN_PATH": str(folder / "build"),
        "GPR_PROJECT_PATH": str(TOP / "sdk" / "ada"),
    }
    subprocess.run(command, cwd=folder, env=environment, check=True)


if __name__ == "__main__":
    main()
