"""The SDKs in Python and Ruby and the fixture managers. `cargo test` has the other languages."""

from __future__ import annotations

from pathlib import Path

import pytest
from checkout import ROOT, call, venv

PYTHON = ROOT / "sdk/python"
RUBY = ROOT / "sdk/ruby"


@pytest.mark.parametrize("tool", ["ruff check .", "ruff format --check .", "mypy", "pytest"])
def test_python(tool: str) -> None:
    program, *arguments = tool.split()
    call(venv("test") / program, *arguments, cwd=PYTHON)


@pytest.mark.parametrize(
    "file", sorted((ROOT / "tests/fixtures").glob("test_*.py")), ids=lambda it: it.stem
)
def test_fixture_managers(file: Path) -> None:
    options = ["-q", "-p", "no:cacheprovider", "-c", "/dev/null"]
    options += [f"--rootdir={file.parent}", f"--confcutdir={file.parent}"]
    call(venv("test") / "pytest", *options, file)


@pytest.mark.parametrize("file", sorted(RUBY.glob("test/*_test.rb")), ids=lambda it: it.stem)
def test_ruby(file: Path) -> None:
    call("ruby", "-w", "-Ilib", "-Itest", file, cwd=RUBY)


def test_gem(tmp_path: Path) -> None:
    specification = "robot-testing-framework.gemspec"
    call("gem", "build", "--silent", "--output", tmp_path / "rtf.gem", specification, cwd=RUBY)
