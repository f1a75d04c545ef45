#!/usr/bin/env python3
"""Runs example 09 as a user does: all tests, one case, and with a simulator that is killed.

check_example_09.py RTF DIRECTORY
"""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from pathlib import Path

from processes import kill, select
from run import Run, expect, is_a

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


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, example = str(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve()
    suite = str(example / "other-frameworks.xml")
    with tempfile.TemporaryDirectory() as directory:
        results = Path(directory)
        all_tests(Run(rtf, suite, results / "all"))
        case = "Joints/Limits.MovesWithin/elbow"
        one_case(Run(rtf, f"{suite}::limits_test/{case}", results / "case"), case)
        killed(Run(rtf, f"{suite}::limits_test", results / "killed"))
    return 0


def all_tests(run: Run) -> None:
    """Every framework's cases arrive."""
    expect("exit code", run.wait(), 0)
    names = {event["test"]: event["name"] for event in run.events("test-planned")}
    cases: dict[str, Counter[str]] = {name: Counter() for name in names.values()}
    for event in run.events("case-finished"):
        cases[names[event["test"]]][event["verdict"]] += 1
    expect("cases", {name: dict(found) for name, found in cases.items()}, TESTS)
    expect("measured", sum(1 for _ in run.events("measured")), MEASUREMENTS)


def one_case(run: Run, case: str) -> None:
    """A case is selected by its name."""
    expect("exit code", run.wait(), 0)
    expect("cases", [event["name"] for event in run.events("case-started")], [case])


def killed(run: Run) -> None:
    """The cases that had finished before the collapse do not run again."""
    try:
        run.wait_for(lambda event: is_a(event, "case-started") and event["case"] == ELBOW)
        kill(select(lambda _, words, env: is_simulator(words) and is_of(run, env)))
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


def is_simulator(words: list[str]) -> bool:
    """Whether a process is the simulator."""
    return any(Path(word).name == "simulator.py" for word in words[:2])


def is_of(run: Run, environment: list[str]) -> bool:
    """Whether a process belongs to a run."""
    directory = run.journal.parent.resolve()
    return f"RTF_RUN_DIR={directory}" in environment


if __name__ == "__main__":
    sys.exit(main())
