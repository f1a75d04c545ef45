"""The examples of the user's guide are built and run.

All files of a page are written to one directory, and its commands are run there, see pages.py. If
they build nothing, its C++ and Ada plug-ins are built first; suites that they do not run must pass.
"""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from checkout import ROOT, call, output_of, venv
from pages import Commands, commands, write_files

PAGES = """
    README.md docs/explanation/isolation.md docs/reference/junit.md
    docs/tutorials/first-test.md docs/tutorials/first-fixture.md docs/tutorials/cpp-plugin.md
    docs/how-to/writing-tests.md docs/how-to/simulation-time.md docs/how-to/recorders.md
    docs/how-to/real-robot.md docs/how-to/signals.md docs/how-to/envelopes.md
    docs/how-to/golden.md docs/how-to/faults.md docs/how-to/migrating-rtf2.md
    docs/how-to/migrating-launch-testing.md docs/how-to/migrating-pytest.md
    docs/how-to/migrating-robot-framework.md
""".split()

CMAKE_HEADER = """\
cmake_minimum_required(VERSION 3.16)
project(Page LANGUAGES CXX)
find_package(rtf REQUIRED)
"""


@pytest.fixture(autouse=True)
def _environment_of_plugins(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The variables with which a page's plug-ins are built and found."""
    packages = ROOT / "sdk/cpp/cmake"
    monkeypatch.setenv("RTF_PLUGIN_PATH", str(tmp_path / "build"))
    monkeypatch.setenv("RTF_LOCKS", str(tmp_path / "locks"))
    monkeypatch.setenv("GPR_PROJECT_PATH", str(ROOT / "sdk/ada"))
    monkeypatch.setenv("RobotTestingFramework_DIR", str(packages / "RobotTestingFramework"))
    monkeypatch.setenv("rtf_DIR", str(packages / "rtf"))


@pytest.mark.parametrize("page", PAGES)
def test_page(rtf: str, tmp_path: Path, page: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RTF_PYTHON", str(venv("test") / "python"))
    check(rtf, ROOT / page, tmp_path)


@pytest.mark.middleware("ros1")
def test_page_about_replaying(rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With real nodes. Debian's rospy belongs to Debian's Python, which needs `mcap`, too."""
    library = venv("mcap", PATH=f"/usr/bin:{os.environ['PATH']}")
    purelib = "import sysconfig; print(sysconfig.get_path('purelib'))"
    monkeypatch.setenv("PYTHONPATH", output_of(library / "python", "-c", purelib))
    check(rtf, ROOT / "docs/how-to/replay.md", tmp_path)


def check(rtf: str, page: Path, directory: Path) -> None:
    """Builds and runs the examples of one page."""
    suites = write_files(page, directory)
    blocks = list(commands(page))
    if not any("cmake " in block.text for block in blocks):
        build(directory)
    for block in blocks:
        run_commands(rtf, directory, block)
    for suite in suites:
        if not any(suite.name in block.text for block in blocks):
            call(rtf, "run", suite.name, cwd=directory)


def run_commands(rtf: str, directory: Path, block: Commands) -> None:
    """Runs the commands of one block."""
    print(block.text, flush=True)
    ran = subprocess.run(
        ["bash", "-e", "-o", "pipefail", "-c", block.text],
        cwd=directory,
        env=os.environ | {"PATH": f"{Path(rtf).parent}:{os.environ['PATH']}"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    print(ran.stdout, flush=True)
    assert ran.returncode == block.exit_code
    assert block.matches(ran.stdout), f"the page shows another output:\n{block.output}"


def build(directory: Path) -> None:
    """Builds the page's Ada and C++ plug-ins, with its CMakeLists.txt or a default one."""
    for project in sorted(directory.glob("*.gpr")):
        call("gprbuild", "-p", "-q", "-P", project.name, cwd=directory)
    sources = sorted(directory.glob("*.cpp"))
    if not sources:
        return
    cmake = directory / "CMakeLists.txt"
    if not cmake.exists():
        plugins = [f"rtf_add_plugin({source.stem} SOURCES {source.name})\n" for source in sources]
        cmake.write_text(CMAKE_HEADER + "".join(plugins))
    call("cmake", "-S", ".", "-B", "build", cwd=directory)
    call("cmake", "--build", "build", cwd=directory)
