"""The numbers of cases that a framework's own runner counts, and rtf's."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
import xml.etree.ElementTree as ET
from collections import Counter
from pathlib import Path
from typing import Any

from observed import CaseResult, TestResult

SECONDS = 300
WORDS = {"passed": "passed", "skipped": "skipped"}
"""Every other verdict is a failure: frameworks disagree about errors."""


def rtf_counts(test: TestResult, cases: str, left_out: list[str]) -> Counter[str]:
    """The cases of a test by verdict."""
    parents = {case.parent for case in test.by_id.values()}

    def counts(number: int, case: CaseResult) -> bool:
        is_chosen = number not in parents if cases == "leaves" else case.parent is None
        return is_chosen and case.path not in left_out

    chosen = [case for number, case in test.by_id.items() if counts(number, case)]
    return Counter(WORDS.get(case.verdict, "failed") for case in chosen)


def own_counts(own: dict[str, Any], source: Path, out: Path) -> Counter[str]:
    """Runs the framework's own runner and counts its results."""
    with tempfile.TemporaryDirectory() as report:
        places = {"source": source, "out": out, "report": report}
        command = [substitute(word, places) for word in own["command"]]
        done = subprocess.run(
            command,
            cwd=report,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            text=True,
            errors="replace",
            timeout=SECONDS,
            env={**os.environ, **own.get("env", {})},
            check=False,
        )
        files = sorted(Path(report).glob("**/*.xml"))
        counts: Counter[str] = Counter()
        match own["format"]:
            case "counts":
                counts.update(json.loads(done.stdout))
            case "summary":
                counts = summary_counts(done.stdout)
            case "boost":
                counts = boost_counts(ET.parse(files[0]).getroot())
            case "junit":
                for file in files:
                    counts += junit_counts(ET.parse(file).getroot())
        if not counts:
            raise AssertionError(f"{command} reported no case:\n{done.stdout}")
    return counts


def substitute(word: str, places: dict[str, Any]) -> str:
    """Replaces `{out}` and so on."""
    for name, place in places.items():
        word = word.replace("{" + name + "}", str(place))
    return word


def summary_counts(output: str) -> Counter[str]:
    """Reads `test cases: 9 | 5 passed | 2 failed | 1 skipped | 1 failed as expected`.

    Catch2 and doctest print such a line; an expected failure counts as passed.
    """
    [line] = [line for line in output.splitlines() if "test cases: " in line]
    counts: Counter[str] = Counter()
    for field in line.split("|")[1:]:
        number, _, word = field.strip().partition(" ")
        counts["passed" if word == "failed as expected" else word] += int(number)
    return counts


def boost_counts(root: ET.Element) -> Counter[str]:
    """Reads the report of Boost.Test. An aborted case has failed, too."""
    [suite] = root
    words = ("passed", "passed_with_warnings", "failed", "skipped")
    numbers = {word: int(suite.attrib[f"test_cases_{word}"]) for word in words}
    numbers["passed"] += numbers.pop("passed_with_warnings")
    return Counter(numbers)


def junit_counts(root: ET.Element) -> Counter[str]:
    """Counts the cases in a JUnit XML file."""
    counts: Counter[str] = Counter()
    for case in root.iter("testcase"):
        children = {child.tag for child in case}
        if children & {"failure", "error"}:
            counts["failed"] += 1
        elif "skipped" in children or case.get("status") in ("notrun", "disabled"):
            counts["skipped"] += 1
        else:
            counts["passed"] += 1
    return counts
