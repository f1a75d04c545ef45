"""Runs the tests of a public package with rtf, and compares each with pytest's own report.

boltons (https://github.com/mahmoud/boltons, BSD licence) has about 500 tests. Its source
distribution is downloaded from PyPI once, into the user's cache.
"""

from __future__ import annotations

import os
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from checkout import venv
from observed import observe
from run import Run
from sdist import fetch

NAME = "boltons"
VERSION = "26.2.0"
SHA256 = "d39cfd15c1a1c3bd4d705c82252fa9edb8e4f5e8cc039f8e39afac7b1b47e92c"
FEWEST = 500
"""A comparison of no tests would pass."""

SUITE = """<suite name="boltons">
  <env name="PYTHONPATH" value="{source}"/>
  <test type="pytest" name="boltons" param="-p no:cacheprovider"> {source}/tests </test>
</suite>
"""


def test_the_tests_of_a_package_have_the_verdicts_of_pytest(
    rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [name for name in os.environ if name.startswith("PYTEST_")]:
        monkeypatch.delenv(name)
    python = str(venv("pytest") / "python")
    monkeypatch.setenv("RTF_PYTHON", python)
    source = fetch(python, NAME, VERSION, SHA256)
    own = run_pytest(python, source, tmp_path / "own.xml")
    assert run_rtf(rtf, source, tmp_path) == own
    assert len(own) >= FEWEST


def run_pytest(python: str, source: Path, report: Path) -> dict[str, str]:
    """The outcome of each test in pytest's own report."""
    command = [python, "-m", "pytest", "-q", "-p", "no:cacheprovider", f"--junitxml={report}"]
    environment = {**os.environ, "PYTHONPATH": str(source)}
    subprocess.run([*command, "tests"], cwd=source, env=environment, check=False)
    outcomes = {}
    for case in ET.parse(report).getroot().iter("testcase"):
        problems = [child.tag for child in case if child.tag in ("failure", "error", "skipped")]
        outcomes[f"{case.get('classname')}.{case.get('name')}"] = outcome(problems)
    return outcomes


def outcome(problems: list[str]) -> str:
    """One word for a test case of JUnit XML."""
    if not problems:
        return "passed"
    return "skipped" if problems == ["skipped"] else "failed"


def run_rtf(rtf: str, source: Path, directory: Path) -> dict[str, str]:
    """The outcome of each case in the journal of rtf."""
    suite = directory / "suite.xml"
    suite.write_text(SUITE.format(source=source), encoding="utf-8")
    run = Run(rtf, str(suite), directory / "results")
    run.wait()
    (test,) = observe(run.events()).values()
    failed = {"error": "failed", "crashed": "failed"}
    return {
        junit_name(path, directory, source): failed.get(case.verdict, case.verdict)
        for path, case in test.cases.items()
    }


def junit_name(node_id: str, directory: Path, source: Path) -> str:
    """The class name and name that pytest writes for a node id, which is relative."""
    # Parameters may contain `::`.
    address, bracket, parameters = node_id.partition("[")
    file, *rest = address.split("::")
    path = Path(os.path.normpath(directory / file))
    file = str(path.relative_to(source)) if path.is_relative_to(source) else file
    name = ".".join([file.removesuffix(".py").replace("/", "."), *rest])
    return f"{name}{bracket}{parameters}"
