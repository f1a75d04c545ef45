"""Runs pytest projects with rtf, and compares each case with pytest's own JUnit file.

Each directory in `pytest_projects` is a project: plug-ins, options and a layout as real projects
have them.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from checkout import venv
from corpora import SOURCES
from observed import TestResult, observe

PROJECTS = SOURCES / "pytest_projects"
SECONDS = 300

FLAKY = {
    "reruns": {
        "test_reruns.py::test_passes_in_the_second_attempt": 2,
        "test_reruns.py::test_is_set_up_in_the_second_attempt": 2,
    },
    "reruns_in_workers": {"test_workers.py::test_passes_in_the_second_attempt": 2},
    "flaky_plugin": {"test_flaky.py::test_passes_in_the_second_attempt": 2},
    "everything": {"tests/test_all.py::test_passes_in_the_second_attempt": 2},
}
"""The flaky cases of each project, with the number of their attempts."""

REASONS = {
    "workers": ("test_crash.py::test_ends_its_worker", "crashed while running"),
    "reruns": ("test_reruns.py::test_is_never_torn_down", "tear-down: OSError: does not stop"),
    "flaky_plugin": ("test_flaky.py::test_fails_in_all_attempts", "assert 0"),
}
"""The reason of a case that does not pass: a part of it."""

PHASES = {
    "phases": {"test_launch.py::test_phases_fail_at_the_end [shutdown]": "failed"},
}
"""Verdicts of cases with the node id of another one."""

SELECTED = {
    "everything": "tests/test_all.py::test_awaits",
    "coverage": "test_coverage.py::test_raises",
}
"""A case that passes if it is selected, whatever the project's `addopts` are."""

CONFIGURATIONS = (".ini", ".cfg", ".toml")

INTRUSIVE = ("randomly", "flaky")
"""Plug-ins that change each run if they are installed. A project that has them names them."""

SUFFIX = re.compile(r" \[\w+\]$|#\d+$")

RANKS = ("passed", "skipped", "failed")
"""Of several results with one name in JUnit's file, the worst one counts."""

SUITE = '<suite name="s"><test type="pytest" name="t" param="{param}"> . </test></suite>\n'


NAMES = sorted(it.name for it in PROJECTS.iterdir() if any(it.glob("*.*")))


@pytest.mark.parametrize("name", [it for it in NAMES if not it.startswith((".", "_"))])
def test_a_project_has_the_verdicts_of_pytest(rtf: str, tmp_path: Path, name: str) -> None:
    python = str(venv("pytest-projects") / "python")
    differences = list(Project(name, tmp_path).differences(rtf, python))
    assert not differences, "\n".join(differences)


class Project:
    """A project, copied for each run, because pytest writes into it."""

    def __init__(self, name: str, directory: Path) -> None:
        """Copy it twice."""
        self.name = name
        self.own, self.ours = directory / "own" / name, directory / "ours" / name
        self.junit = directory / "junit.xml"
        for copy in (self.own, self.ours):
            shutil.copytree(PROJECTS / name, copy)
        files = (file for file in self.own.glob("*.*") if file.suffix in CONFIGURATIONS)
        text = "".join(file.read_text() for file in files)
        blocked = (plugin for plugin in INTRUSIVE if plugin not in text)
        self.options = [word for plugin in blocked for word in ("-p", f"no:{plugin}")]

    def differences(self, rtf: str, python: str) -> Iterator[str]:
        """Compare the cases, the exit code, and what is expected in addition."""
        own, own_code = self.run_pytest(python)
        test, code, output, counts = self.run_rtf(rtf, python)
        if self.name in SELECTED:
            yield from self.selection(rtf, python, SELECTED[self.name])
        ours = rtf_outcomes(test)
        for name in sorted(own.keys() | ours.keys()):
            if own.get(name) != ours.get(name):
                yield f"{name}: pytest {own.get(name)}, rtf {ours.get(name)}"
        if not own:
            yield "pytest ran no test"
        if (own_code == 0) != (code == 0):
            yield f"exit code {own_code} of pytest, {code} of rtf: {test.reason}\n{output}"
        # An error of the test itself would be one of rtf.
        if not (own_code == 0 or test.reason.startswith("case ")):
            yield f"the reason is that of no case: {test.reason}"
        yield from self.expectations(test, counts)

    def selection(self, rtf: str, python: str, case: str) -> Iterator[str]:
        """Run one case, which passes."""
        test, code, output, _ = self.run_rtf(rtf, python, case)
        verdicts = {path: case.verdict for path, case in test.cases.items()}
        if (code, verdicts) != (0, {case: "passed"}):
            yield f"selected: exit code {code}, {verdicts}\n{output}"

    def expectations(self, test: TestResult, counts: dict[str, int]) -> Iterator[str]:
        """Compare flaky cases, reasons and phases with the tables."""
        flaky = {path: attempts for path, attempts in counts.items() if attempts > 1}
        flaky = {path: n for path, n in flaky.items() if test.cases[path].verdict == "passed"}
        if flaky != FLAKY.get(self.name, {}):
            yield f"flaky cases: {flaky}"
        reruns = dict(reruns_in(self.junit))
        for path, attempts_of in counts.items():
            expected = (attempts_of - 1, test.cases[path].verdict == "passed")
            if attempts_of > 1 and reruns.get(path) != expected:
                yield f"{path}: JUnit has {reruns.get(path)}, expected {expected}"
        path, reason = REASONS.get(self.name, ("", ""))
        if path and reason not in test.cases[path].reason:
            yield f"{path}: reason: {test.cases[path].reason}"
        for path, verdict in PHASES.get(self.name, {}).items():
            if path not in test.cases or test.cases[path].verdict != verdict:
                yield f"{path} is not {verdict}: {sorted(test.cases)}"

    def run_pytest(self, python: str) -> tuple[dict[str, str], int]:
        """Return the outcome of each test in pytest's own report, and the exit code."""
        report = self.own.parent / "own.xml"
        # Some have `-x` in `addopts`; the runner runs all cases.
        options = [*self.options, "--maxfail=1000", f"--junitxml={report}"]
        done = subprocess.run(
            [python, "-m", "pytest", *options, "."],
            cwd=self.own,
            env=clean_environment(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=SECONDS,
            check=False,
        )
        outcomes: dict[str, str] = {}
        for case in ET.parse(report).getroot().iter("testcase"):
            problems = {child.tag for child in case} & {"failure", "error", "skipped"}
            outcome = "passed" if not problems else "failed"
            outcome = "skipped" if problems == {"skipped"} else outcome
            # A module that skips itself has no class.
            name = f"{case.get('classname')}.{case.get('name')}".lstrip(".")
            add(outcomes, name, outcome)
        return outcomes, done.returncode

    def run_rtf(
        self, rtf: str, python: str, case: str | None = None
    ) -> tuple[TestResult, int, str, dict[str, int]]:
        """Return the results in the journal, the exit code, the output, and attempts."""
        suite = self.ours / "suite.xml"
        suite.write_text(SUITE.format(param=" ".join(self.options)))
        results = self.ours.parent / "results"
        # The report is that of the run with all cases.
        report = [] if case else ["--report", f"junit={self.junit}"]
        target = f"{suite}::t/{case}" if case else str(suite)
        done = subprocess.run(
            [rtf, "run", "--results", str(results), *report, target],
            cwd=self.ours,
            env={**clean_environment(), "RTF_PYTHON": python},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=SECONDS,
            check=False,
        )
        journal = (results / "latest" / "events.jsonl").read_text().splitlines()
        events = [json.loads(line) for line in journal]
        tests = observe(events)
        return tests["t"], done.returncode, done.stdout, dict(attempts(events))


def clean_environment() -> dict[str, str]:
    """Return the environment without options of pytest."""
    return {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}


def reruns_in(report: Path) -> Iterator[tuple[str, tuple[int, bool]]]:
    """Return the number of reruns of each case, and whether it is flaky."""
    for case in ET.parse(report).getroot().iter("testcase"):
        tags = [child.tag for child in case if child.tag.startswith(("flaky", "rerun"))]
        if tags:
            yield case.attrib["name"], (len(tags), tags[0].startswith("flaky"))


def attempts(events: list[dict[str, Any]]) -> Iterator[tuple[str, int]]:
    """Return the number of attempts of each top-level case."""
    for event in events:
        if event["type"] == "case-started" and "parent" not in event:
            yield event["name"], event.get("earlier_attempts", 0) + 1


def add(outcomes: dict[str, str], name: str, outcome: str) -> None:
    """Add an outcome; the worst one of a name counts."""
    outcomes[name] = max(outcomes.get(name, outcome), outcome, key=RANKS.index)


def rtf_outcomes(test: TestResult) -> dict[str, str]:
    """Return the outcome of each top-level case under the name in JUnit's file."""
    words = {"passed": "passed", "skipped": "skipped"}
    last = {case.path: case for case in test.by_id.values() if case.parent is None}
    outcomes: dict[str, str] = {}
    for path, case in last.items():
        # Phases and repetitions have the node id of another case.
        node_id = next((it for it in SUFFIX.split(path)[:1] if it in last), path)
        add(outcomes, junit_name(node_id), words.get(case.verdict, "failed"))
    # In JUnit's file, a skipped subtest is one of its test.
    for case in test.by_id.values():
        if case.parent is not None and case.verdict == "skipped":
            add(outcomes, junit_name(test.by_id[case.parent].path), "skipped")
    return outcomes


def junit_name(node_id: str) -> str:
    """Return the class name and name that pytest writes for a node id."""
    address, bracket, parameters = node_id.partition("[")
    file, *rest = address.split("::")
    name = ".".join([file.replace("/", ".").removesuffix(".py"), *rest])
    return xml_text(f"{name}{bracket}{parameters}")


def xml_text(text: str) -> str:
    """Return a text as pytest writes characters that XML cannot have."""
    return text
