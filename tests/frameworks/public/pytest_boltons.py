#!/usr/bin/env python3
"""Runs the tests of a public package with rtf, and compares each with pytest's own report.

    pytest_boltons.py RTF PYTHON

boltons (https://github.com/mahmoud/boltons, BSD licence) has about 500 tests. Its source
distribution is downloaded from PyPI once, into the user's cache. PYTHON has pytest.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests/frameworks")]

from observed import observe  # noqa: E402
from run import Run  # noqa: E402
from sdist import fetch  # noqa: E402

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


def main() -> int:
    """Prints all differences; the exit code is 1 if there is any."""
    rtf, python = str(Path(sys.argv[1]).resolve()), str(Path(sys.argv[2]).absolute())
    source = fetch(python, NAME, VERSION, SHA256)
    with tempfile.TemporaryDirectory() as directory:
        own = run_pytest(python, source, Path(directory) / "own.xml")
        ours = run_rtf(rtf, python, source, Path(directory))
    names = own.keys() | ours.keys()
    different = [name for name in sorted(names) if own.get(name) != ours.get(name)]
    for name in different:
        print(f"different: {name}: pytest {own.get(name)}, rtf {ours.get(name)}")
    if len(own) < FEWEST:
        print(f"pytest ran only {len(own)} tests, expected {FEWEST}")
        return 1
    print(f"{len(names) - len(different)} passed, {len(different)} failed")
    return 1 if different else 0


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


def run_rtf(rtf: str, python: str, source: Path, directory: Path) -> dict[str, str]:
    """The outcome of each case in the journal of rtf."""
    suite = directory / "suite.xml"
    suite.write_text(SUITE.format(source=source), encoding="utf-8")
    os.environ["RTF_PYTHON"] = python
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


if __name__ == "__main__":
    sys.exit(main())
