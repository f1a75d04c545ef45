"""Runs example 09 as a user does: all tests, one case, and with a simulator that is killed."""

from __future__ import annotations

import fcntl
import functools
from collections import Counter
from pathlib import Path

import pytest
from checkout import BUILD, ROOT, call, exports, venv
from processes import kill, running
from run import Run, expect, is_a

pytestmark = [pytest.mark.venv("demo"), pytest.mark.first]
EXAMPLE = ROOT / "examples/09-other-frameworks"
SUITE = str(EXAMPLE / "other-frameworks.xml")
TESTS = {
    "limits_test": {"passed": 6, "skipped": 1},
    "reach_test": {"passed": 8},
    "encoder_test": {"passed": 2},
    "rest_test": {"passed": 3},
    "repeatability": {"passed": 4, "skipped": 1},
    "test_rate.py": {"passed": 3, "skipped": 1},
    "command line": {"passed": 4},
}
"""The verdicts of the cases of each test, with the cases in cases."""
MEASUREMENTS = 3 + 1 + 3 + 3
ELBOW = 3
"""The case that moves the elbow: the one before it takes more than 200 ms."""


@pytest.fixture(autouse=True)
def _programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Another test may use its own arm.
    monkeypatch.setenv("RTF_LOCKS", str(tmp_path / "locks"))
    monkeypatch.setenv("RTF_PYTHON", str(venv("test") / "python"))
    monkeypatch.setenv("RTF_PLUGIN_PATH", str(programs()))


@functools.cache
def programs() -> Path:
    """Builds the programs of the lesson with all frameworks; their directory."""
    built = BUILD / "examples/09-other-frameworks"
    settings = {
        "GPR_PROJECT_PATH": str(ROOT / "sdk/ada"),
        "rtf_DIR": str(ROOT / "sdk/cpp/cmake/rtf"),
    }
    for framework in ("gtest", "catch2", "cppunit", "aunit", "junit"):
        settings |= exports("tests/frameworks/build.sh", framework)
    settings.pop("PATH", None)
    BUILD.mkdir(exist_ok=True)
    with (BUILD / "09-other-frameworks.lock").open("a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        call(EXAMPLE / "build.sh", built, cwd=ROOT, **settings)
    return built


def test_the_cases_of_each_framework_arrive(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, SUITE, tmp_path / "results")
    expect("exit code", run.wait(), 0)
    names = {event["test"]: event["name"] for event in run.events("test-planned")}
    cases: dict[str, Counter[str]] = {name: Counter() for name in names.values()}
    for event in run.events("case-finished"):
        cases[names[event["test"]]][event["verdict"]] += 1
    expect("cases", {name: dict(found) for name, found in cases.items()}, TESTS)
    expect("measured", sum(1 for _ in run.events("measured")), MEASUREMENTS)


def test_a_case_is_selected_by_its_name(rtf: str, tmp_path: Path) -> None:
    case = "Joints/Limits.MovesWithin/elbow"
    run = Run(rtf, f"{SUITE}::limits_test/{case}", tmp_path / "results")
    expect("exit code", run.wait(), 0)
    expect("cases", [event["name"] for event in run.events("case-started")], [case])


def test_cases_that_finished_before_a_collapse_are_not_rerun(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, f"{SUITE}::limits_test", tmp_path / "results")
    try:
        run.wait_for(lambda event: is_a(event, "case-started") and event["case"] == ELBOW)
        kill(running("simulator.py"))
    except BaseException:
        run.stop()
        raise
    expect("exit code", run.wait(), 1)
    expect("collapses", len(run.reasons()), 1)
    expect("attempts", run.attempts(), ["collapsed", "passed"])
    last = list(run.events())
    last = last[max(at for at, event in enumerate(last) if is_a(event, "test-started")) :]
    finished = [event for event in last if is_a(event, "case-finished")]
    expect("cases", Counter(event["verdict"] for event in finished), {"passed": 6, "skipped": 1})
    carried = sum("carried" in event for event in finished)
    expect("some cases were carried", 1 <= carried <= len(finished) - 1, True)
