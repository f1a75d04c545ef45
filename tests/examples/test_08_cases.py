"""Runs example 08 as a user does: all tests, one joint, one case, and with skips that count."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from checkout import ROOT
from run import Run, expect, expect_in

pytestmark = pytest.mark.venv("demo")
SUITE = str(ROOT / "examples/08-cases/cases.xml")
TESTS = {
    "PosesTest[joint=shoulder,load=empty]",
    "PosesTest[joint=elbow,load=empty]",
    "PosesTest[joint=elbow,load=full]",
    "PosesTest[joint=wrist,load=empty]",
    "PosesTest[joint=wrist,load=full]",
    "DriftTest",
}


def test_a_known_failure_and_skips_leave_the_run_green(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, SUITE, tmp_path / "results")
    expect("exit code", run.wait(), 0)
    expect("tests", {event["name"] for event in run.events("test-planned")}, TESTS)
    expect("verdicts", Counter(run.verdicts().values()), {"passed": 5, "failed": 1})
    expect("cases", cases(run), {"passed": 13, "skipped": 2})
    [port] = run.events("fixture-provided")
    expect("the port is a value", port["name"], "port")
    expect("measured", sum(1 for _ in run.events("measured")), 13)
    expect_in("quarantined", run.output.read_text())


def test_a_filter_selects_combinations(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, SUITE, tmp_path / "results", "-E", "param(joint=elbow)")
    expect("exit code", run.wait(), 0)
    expect("cases", cases(run), {"passed": 5, "skipped": 1})


def test_a_case_is_selected_by_its_path(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, f"{SUITE}::PosesTest[joint=elbow,load=empty]/high", tmp_path / "results")
    expect("exit code", run.wait(), 0)
    expect("cases", [event["name"] for event in run.events("case-started")], ["high"])


def test_skips_count_if_asked(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, SUITE, tmp_path / "results", "--no-skips")
    expect("exit code", run.wait(), 1)
    expect("cases", cases(run), {"passed": 13, "skipped": 2})


def cases(run: Run) -> Counter[str]:
    """The number of cases by verdict."""
    return Counter(event["verdict"] for event in run.events("case-finished"))
