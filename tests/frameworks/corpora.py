"""The corpora of the test frameworks, one directory each, and their builds."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from _pytest.mark import ParameterSet
from checkout import BUILD, exports

SOURCES = Path(__file__).resolve().parent
BUILDS = BUILD / "frameworks"
TYPES = sorted(file.parent.name for file in SOURCES.glob("*/build.sh"))


def parameter(framework: str, value: object, name: str, group: str = "") -> ParameterSet:
    """A value with a name, for a test that needs this framework.

    Tests of a group share results, and run in one process.
    """
    marks = [pytest.mark.middleware("ros1")] if framework == "rostest" else []
    if framework == "junit":  # each virtual machine takes a second
        marks.append(pytest.mark.first)
    if group:
        marks.append(pytest.mark.xdist_group(f"{group}-{framework}"))
    return pytest.param(value, id=f"{framework}-{name}", marks=marks)


def build(framework: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Builds a corpus unless it is up to date, and exports what it needs."""
    for name in [name for name in os.environ if name.startswith("PYTEST_")]:
        monkeypatch.delenv(name)  # frameworks may also be pytest
    for name, value in exports("tests/frameworks/build.sh", framework).items():
        rest = os.environ["PATH"] if name == "PATH" else ""
        monkeypatch.setenv(name, value + rest)
