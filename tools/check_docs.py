#!/usr/bin/env python3
"""Builds and runs the examples of the user's guide.

    check_docs.py RTF PAGE…

A code block whose first line is a comment with a file name is that file. All files of a page
are written to one directory, its C++ and Ada plug-ins are built, and its suites must pass.
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
        with tempfile.TemporaryDirectory() as directory:
            check(rtf, page, Path(directory))


def check(rtf: Path, page: Path, directory: Path) -> None:
    """Builds and runs the examples of one page."""
    suites = write_files(page, directory)
    build(directory)
    for suite in suites:
        print(f"{page}: {suite.name}", flush=True)
        call(directory, str(rtf), "run", suite.name)


def build(directory: Path) -> None:
    """Builds the page's Ada and C++ plug-ins, with its CMakeLists.txt or a default one."""
    for project in sorted(directory.glob("*.gpr")):
        call(directory, "gprbuild", "-p", "-q", "-P", project.name)
    sources = sorted(directory.glob("*.cpp"))
    if not sources:
        return
    cmake = directory / "CMakeLists.txt"
    if not cmake.exists():
        plugins = [
            f"robottestingframework_add_plugin({source.stem} SOURCES {source.name})\n"
            for source in sources
        ]
        cmake.write_text(CMAKE_HEADER + "".join(plugins))
    package = TOP / "sdk" / "cpp" / "cmake" / "RobotTestingFramework"
    call(directory, "cmake", "-S", ".", "-B", "build", f"-DRobotTestingFramework_DIR={package}")
    call(directory, "cmake", "--build", "build")


def call(directory: Path, *command: str) -> None:
    """Runs a command, which must succeed."""
    environment = os.environ | {
        "RTF_PLUGIN_PATH": str(directory / "build"),
        "GPR_PROJECT_PATH": str(TOP / "sdk" / "ada"),
    }
    subprocess.run(command, cwd=directory, env=environment, check=True)


if __name__ == "__main__":
    main()
