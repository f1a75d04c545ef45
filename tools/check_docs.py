#!/usr/bin/env python3
"""Builds and runs the examples of the user's guide.

    check_docs.py RTF PAGE…

All files of a page are written to one directory, and its commands are run there, see pages.py. If
they build nothing, its C++ and Ada plug-ins are built first; suites that they do not run must pass.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from pages import Commands, commands, write_files

TOP = Path(__file__).resolve().parent.parent

CMAKE_HEADER = """\
cmake_minimum_required(VERSION 3.16)
project(Page LANGUAGES CXX)
find_package(rtf REQUIRED)
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
    blocks = list(commands(page))
    if not any("cmake " in block.text for block in blocks):
        build(directory)
    for block in blocks:
        print(f"{page}:\n{block.text}", flush=True)
        run_commands(rtf, directory, block)
    for suite in suites:
        if not any(suite.name in block.text for block in blocks):
            print(f"{page}: {suite.name}", flush=True)
            call(directory, str(rtf), "run", suite.name)


def run_commands(rtf: Path, directory: Path, block: Commands) -> None:
    """Runs the commands of one block."""
    ran = subprocess.run(
        ["bash", "-e", "-o", "pipefail", "-c", block.text],
        cwd=directory,
        env=environment(directory) | {"PATH": f"{rtf.parent}:{os.environ['PATH']}"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    print(ran.stdout, flush=True)
    if ran.returncode != block.exit_code:
        raise SystemExit(f"exit code {ran.returncode}, expected {block.exit_code}")
    if not block.matches(ran.stdout):
        raise SystemExit(f"the page shows another output:\n{block.output}")


def build(directory: Path) -> None:
    """Builds the page's Ada and C++ plug-ins, with its CMakeLists.txt or a default one."""
    for project in sorted(directory.glob("*.gpr")):
        call(directory, "gprbuild", "-p", "-q", "-P", project.name)
    sources = sorted(directory.glob("*.cpp"))
    if not sources:
        return
    cmake = directory / "CMakeLists.txt"
    if not cmake.exists():
        plugins = [f"rtf_add_plugin({source.stem} SOURCES {source.name})\n" for source in sources]
        cmake.write_text(CMAKE_HEADER + "".join(plugins))
    call(directory, "cmake", "-S", ".", "-B", "build")
    call(directory, "cmake", "--build", "build")


def call(directory: Path, *command: str) -> None:
    """Runs a command, which must succeed."""
    subprocess.run(command, cwd=directory, env=environment(directory), check=True)


def environment(directory: Path) -> dict[str, str]:
    """The variables with which a page's plug-ins are built and found."""
    packages = TOP / "sdk" / "cpp" / "cmake"
    return os.environ | {
        "RTF_PLUGIN_PATH": str(directory / "build"),
        "RTF_LOCKS": str(directory / "locks"),
        "GPR_PROJECT_PATH": str(TOP / "sdk" / "ada"),
        "RobotTestingFramework_DIR": str(packages / "RobotTestingFramework"),
        "rtf_DIR": str(packages / "rtf"),
    }


if __name__ == "__main__":
    main()
