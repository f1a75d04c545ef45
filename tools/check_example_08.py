#!/usr/bin/env python3
"""Runs example 08 as a user does: all tests, one joint, one case, and with skips that count.

check_example_08.py RTF DIRECTORY
"""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from pathlib import Path

from run import Run, expect, expect_in

TESTS = {
    "PosesTest[joint=shoulder,load=empty]",
    "PosesTest[joint=elbow,load=empty]",
    "PosesTest[joint=elbow,load=full]",
    "PosesTest[joint=wrist,load=empty]",
    "PosesTest[joint=wrist,load=full]",
    "DriftTest",
}


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, example = str(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve()
    suite = str(example / "cases.xml")
    with tempfile.TemporaryDirectory() as directory:
        results = Path(directory)
        all_tests(Run(rtf, suite, results / "all"))
        one_joint(Run(rtf, suite, results / "joint", "-E", "param(joint=elbow)"))
        one_case(Run(rtf, f"{suite}::PosesTest[joint=elbow,load=empty]/high", results / "case"))
        skips_count(Run(rtf, suite, results / "skips", "--no-skips"))
    return 0


def all_tests(run: Run) -> None:
    """The known failure and the skipped cases leave the run green."""
    expect("exit code", run.wait(), 0)
    expect("tests", {event["name"] for event in run.events("test-planned")}, TESTS)
    expect("verdicts", Counter(run.verdicts().values()), {"passed": 5, "failed": 1})
    expect("cases", cases(run), {"passed": 13, "skipped": 2})
    [port] = run.events("fixture-provided")
    expect("the port is a value", port["name"], "port")
    expect("measured", sum(1 for _ in run.events("measured")), 13)
    expect_in("quarantined", run.output.read_text())


def one_joint(run: Run) -> None:
    """A filter selects combinations."""
    expect("exit code", run.wait(), 0)
    expect("cases", cases(run), {"passed": 5, "skipped": 1})


def one_case(run: Run) -> None:
    """A case is selected by its path."""
    expect("exit code", run.wait(), 0)
    expect("cases", [event["name"] for event in run.events("case-started")], ["high"])


def skips_count(run: Run) -> None:
    """The same run is red if skips count."""
    expect("exit code", run.wait(), 1)
    expect("cases", cases(run), {"passed": 13, "skipped": 2})


def cases(run: Run) -> Counter[str]:
    """The number of cases by verdict."""
    return Counter(event["verdict"] for event in run.events("case-finished"))


if __name__ == "__main__":
    sys.exit(main())
