"""Runs the corpus of each framework with rtf, and compares all results with a table.

The corpus is `tests/frameworks/TYPE`. Its `expected.json` is the table:

    {
      "runs": [
        {
          "name": "all",                       for messages, and for `own`
          "verb": "run",                       or `check`, `list`; default `run`
          "input": "suite.xml",                relative to the corpus; may have `::TEST/CASE`
          "options": [],                       further arguments of rtf
          "exit": 1,
          "prints": ["…"],                     texts in the output of rtf
          "tests": {                           exactly the tests that the run reports
            "arm_test": {
              "verdict": "failed",
              "reason": "…",                   a part of it
              "stdout": ["…"], "stderr": ["…"],    parts of its output
              "silent": ["<?xml"],             texts that its output must not contain
              "stacks": ["…"],                 parts of its stack dumps
              "measured": {}, "messages": ["…"],    outside of its cases, as below
              "like": "arm_test",              everything else is as in this test of the run
              "counts": {"passed": 9},         instead of `cases`: how many have each verdict
              "cases": {                       exactly the cases that it reports
                "Arm.Passes": "passed",        short for {"verdict": "passed"}
                "Arm.Fails": {                 a path: `CASE/CASE IN IT`
                  "verdict": "failed",
                  "reason": "…",               required, unless it passed
                  "location": "arm_test.cpp: fails",    of its first failure or error
                  "starts": "arm_test.cpp: Fails",      of the case itself
                  "tags": [], "parameters": {}, "measured": {},   exactly these
                  "measures": ["…"],           instead of `measured`: only the names
                  "takes": 0.2,                at least this many seconds
                  "messages": ["…"]            each is a part of a message of the case
      …
      "own": [
        {
          "command": ["{out}/arm_test", "--gtest_output=xml:{report}/a.xml"],
          "format": "junit",                   or `counts`: it prints {"passed":1,"failed":2,…};
                                               or the `summary` of Catch2 and doctest, `boost`
          "compare": ["all", "arm_test"],      the run and its test
          "cases": "top",                      or `leaves`
          "left_out": ["Arm.Crashes"],         cases that the command does not run
          "verdicts": ["passed", "failed"]     the compared numbers; default also `skipped`
        }
      ]
    }

A location names a file and a marker: the line of the file that contains `line: fails`.
`own` runs the framework's own runner and compares the numbers of cases that passed, failed
(or had an error, or crashed) and were skipped. In `command`, `{out}` is the directory of the
build, `{source}` that of the corpus, and `{report}` an empty directory.
"""

from __future__ import annotations

import json
import os
import subprocess
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from corpora import BUILDS, SOURCES, TYPES, build, parameter
from observed import CaseResult, TestResult, observe
from own_results import own_counts, rtf_counts
from run import Run

Table = dict[str, Any]


TABLES = {name: json.loads((SOURCES / name / "expected.json").read_text()) for name in TYPES}


def title_of(run: Table) -> str:
    """The name of a run."""
    return str(run.get("name", run["input"]))


@pytest.mark.parametrize(
    "entry",
    [
        parameter(framework, (framework, run), title_of(run))
        for framework, table in TABLES.items()
        for run in table["runs"]
    ],
)
def test_results_are_those_of_the_table_and_of_the_framework(
    rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, entry: tuple[str, Table]
) -> None:
    framework, run = entry
    build(framework, monkeypatch)
    corpus = Corpus(framework)
    results = corpus.check_run(rtf, run, tmp_path / "results")
    for own in TABLES[framework]["own"]:
        name, test = own["compare"]
        if name == title_of(run):
            corpus.check_own(own, test, results[test])
    assert not corpus.differences, "\n".join(corpus.differences)


def test_counts_of_frameworks_are_compared_with_runs_that_exist() -> None:
    for framework, table in TABLES.items():
        runs = {title_of(run) for run in table["runs"]}
        assert {own["compare"][0] for own in table["own"]} <= runs, framework


class Corpus:
    """The corpus of a framework, and all differences from its table."""

    def __init__(self, framework: str) -> None:
        self.source, self.out = SOURCES / framework, BUILDS / framework
        self.differences: list[str] = []

    def check_run(self, rtf: str, run: Table, directory: Path) -> dict[str, TestResult]:
        """Runs rtf once and compares its exit code, output and tests with the table."""
        title = title_of(run)
        file, *selected = run["input"].split("::", maxsplit=1)
        target = "::".join([str(self.source / file), *selected])
        options = [str(option) for option in run.get("options", [])]
        tests: dict[str, TestResult] = {}
        if run.get("verb", "run") == "run":
            ours = Run(rtf, target, directory, *options)
            code = ours.wait()
            output = ours.output.read_text(errors="replace")
            tests = observe(ours.events())
        else:
            code, output = run_verb(rtf, run["verb"], *options, target)
        self.expect(f"{title}: exit code", code, run["exit"])
        for text in run.get("prints", []):
            self.expect_part(f"{title}: output of rtf", output, text)
        expected = run.get("tests", {})
        self.expect(f"{title}: tests", sorted(tests), sorted(expected))
        for name in expected.keys() & tests.keys():
            like = expected.get(expected[name].get("like", name), {})
            self.check_test(f"{title}: {name}", tests[name], {**like, **expected[name]})
        return tests

    def check_test(self, title: str, got: TestResult, expected: Table) -> None:
        """Compares a test and its cases."""
        self.expect(f"{title}: verdict ({got.reason})", got.verdict, expected["verdict"])
        self.expect_reason(title, got.reason, expected)
        for stream in ("stdout", "stderr"):
            for text in expected.get(stream, []):
                self.expect_part(f"{title}: {stream}", got.output[stream], text)
            for text in expected.get("silent", []):
                self.expect(f"{title}: `{text}` in {stream}", text in got.output[stream], False)
        for text in expected.get("stacks", []):
            self.expect_part(f"{title}: stack dump", got.stacks, text)
        self.expect(f"{title}: measured", got.measured, expected.get("measured", {}))
        self.expect_messages(title, got.messages, expected)
        if "counts" in expected:
            counts = Counter(case.verdict for case in got.cases.values())
            self.expect(f"{title}: counts", dict(counts), expected["counts"])
            return
        cases = expected.get("cases", {})
        self.expect(f"{title}: cases", sorted(got.cases), sorted(cases))
        for path in cases.keys() & got.cases.keys():
            each = cases[path]
            each = {"verdict": each} if isinstance(each, str) else each
            self.check_case(f"{title}: {path}", got.cases[path], each)

    def check_case(self, title: str, got: CaseResult, expected: Table) -> None:
        """Compares a case; what the table does not mention must be absent."""
        self.expect(f"{title}: verdict ({got.reason})", got.verdict, expected["verdict"])
        self.expect_reason(title, got.reason, expected)
        self.expect(f"{title}: tags", sorted(got.tags), sorted(expected.get("tags", [])))
        self.expect(f"{title}: parameters", got.parameters, expected.get("parameters", {}))
        if "measures" in expected:
            self.expect(f"{title}: measured", sorted(got.measured), sorted(expected["measures"]))
        else:
            self.expect(f"{title}: measured", got.measured, expected.get("measured", {}))
        self.expect_messages(title, got.messages, expected)
        if got.seconds < expected.get("takes", 0.0):
            self.expect(f"{title}: seconds", got.seconds, expected["takes"])
        for key, location in (("location", got.problem_location), ("starts", got.location)):
            if key in expected:
                line = self.marked(expected[key])
                self.expect(f"{title}: {key}", location, line)

    def expect_reason(self, title: str, reason: str, expected: Table) -> None:
        """Everything that did not pass has a reason."""
        if expected["verdict"] != "passed":
            self.expect_part(f"{title}: reason", reason, expected["reason"])

    def expect_messages(self, title: str, messages: list[str], expected: Table) -> None:
        """Each expected text is a part of a message."""
        for text in expected.get("messages", []):
            found = any(text in message for message in messages)
            self.expect(f"{title}: `{text}` in {messages}", found, True)

    def check_own(self, own: Table, test: str, result: TestResult) -> None:
        """Compares the numbers of cases with those of the framework's own runner."""
        title = f"{test}: counts of the framework"
        got = rtf_counts(result, own.get("cases", "top"), own.get("left_out", []))
        theirs = own_counts(own, self.source, self.out)
        for verdict in own.get("verdicts", ["passed", "failed", "skipped"]):
            self.expect(f"{title}: {verdict}", got[verdict], theirs[verdict])

    def marked(self, location: str) -> str:
        """The `FILE:LINE` of a `FILE: MARKER`."""
        name, marker = location.split(": ", maxsplit=1)
        lines = (self.source / name).read_text().splitlines()
        found = [at for at, line in enumerate(lines, 1) if line.endswith(f"line: {marker}")]
        assert len(found) == 1, f"{name}: {len(found)} lines end with `line: {marker}`"
        return f"{Path(name).name}:{found[0]}"

    def expect(self, what: str, got: object, expected: object) -> None:
        """Remembers a difference."""
        if got != expected:
            self.differences.append(f"{what}: got {got!r}, expected {expected!r}")

    def expect_part(self, what: str, got: str, text: str) -> None:
        """Remembers that a text is missing in another; an empty text only matches itself."""
        self.expect(f"{what}: `{text}` in {got!r}", text in got if text else not got, True)


def run_verb(rtf: str, *arguments: str) -> tuple[int, str]:
    """Runs `rtf check` or `rtf list`."""
    done = subprocess.run(
        [rtf, *arguments],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        env={**os.environ, "NO_COLOR": "1"},
        check=False,
    )
    print(done.stdout, flush=True)
    return done.returncode, done.stdout
