"""The order of tests, see harness/order.py."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import order

CONFTEST = """
import order, pytest

def pytest_configure(config):
    config.pluginmanager.register(order)

@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items, config):
    order.longest_first(items, config)
"""
TESTS = """
import pytest

def test_new(): pass
def test_short(): pass
@pytest.mark.first
def test_new_and_long(): pass
@pytest.mark.first(2)
def test_new_and_longer(): pass
@pytest.mark.parametrize("at", ["@", "home"])
@pytest.mark.xdist_group("g")
def test_in_a_group(at): pass
def test_long(): pass
def test_longer(): assert False
"""
DURATIONS = {
    "test_all.py::test_short": 0.5,
    "test_all.py::test_in_a_group[@]": 3,
    "test_all.py::test_in_a_group[home]": 3,
    "test_all.py::test_long": 5,
    "test_all.py::test_longer": 7,
}


def run(directory: Path, *options: str) -> list[str]:
    """Runs tests in processes that share a record; their names in the order of their starts."""
    variables = {"XDG_CACHE_HOME": str(directory), "PYTHONPATH": str(Path(order.__file__).parent)}
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-v", *options]
    environment = {name: it for name, it in os.environ.items() if not name.startswith("PYTEST_")}
    output = subprocess.run(
        [*command, "-c", "pytest.ini", "test_all.py"],
        cwd=directory,
        env=environment | variables,
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    ).stdout
    lines = [line for line in output.splitlines() if "PASSED" in line or "FAILED" in line]
    names = [line.partition("::")[2].split()[0] for line in lines if "::" in line]
    assert len(names) >= 8, output
    return [name.removeprefix("test_").partition("@g")[0] for name in names[:8]]


def test_the_longest_starts_first_and_the_shortest_wait_behind_it(tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text(CONFTEST)
    (tmp_path / "test_all.py").write_text(TESTS)
    (tmp_path / "pytest.ini").write_text("[pytest]\nmarkers = first(minutes): is long\n")
    file = tmp_path / "rtf/durations.json"

    # Without a record, only the mark counts.
    declared = ["new", "short", "in_a_group[@]", "in_a_group[home]", "long", "longer"]
    assert run(tmp_path) == ["new_and_longer", "new_and_long", *declared]
    assert len(json.loads(file.read_text())) == 7  # one has failed

    file.write_text(json.dumps(DURATIONS))
    longest = ["longer", "in_a_group[@]", "in_a_group[home]", "long", "short"]
    assert run(tmp_path) == ["new_and_longer", "new_and_long", *longest, "new"]
    recorded = json.loads(file.read_text())
    assert recorded["test_all.py::test_longer"] == 7
    assert recorded["test_all.py::test_long"] < 1

    file.write_text(json.dumps(DURATIONS))
    options = ["-n", "1", "--dist", "loadgroup", "--no-loadscope-reorder"]
    assert run(tmp_path, *options) == ["new_and_longer", "new", "new_and_long", *longest]
    assert set(json.loads(file.read_text())) >= set(recorded)
