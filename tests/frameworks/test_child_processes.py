"""Compares the verdicts of programs whose cases start processes, with and without rtf.

The programs run without rtf, where the framework permits each case alone, and in each isolation
mode of rtf. The verdicts of the cases are the same everywhere, each case is reported once, and
nothing is reported outside of the cases, unless the framework's own report says that something
is wrong there.
"""

from __future__ import annotations

import functools
import os
import re
import shlex
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

import own_reports
import pytest
from _pytest.mark import ParameterSet
from checkout import ROOT
from corpora import BUILDS, SOURCES, TYPES, build, parameter
from observed import TestResult, observe
from own_reports import OUTSIDE, Verdicts
from run import Run

HERE = SOURCES / "descendants"
RUNS: dict[str, list[str]] = {"executed": ["--fork", "never"], "forked": []}
"""Options of rtf; the second run is for programs that can be forked."""

ONE = ""
SEPARATE = 'isolation="case"'
AT_MAIN = 'isolation="case" fork="main"'


@dataclass(frozen=True, eq=False)
class Corpus:
    """The programs of a type."""

    programs: list[str]
    modes: list[str]
    """Attributes of tests."""
    names: Sequence[str] = ()
    """Cases that each program has: the last part of their name."""
    command: Callable[[str, str], list[str]] | None = None
    """Runs one case of a program without rtf."""
    report: Callable[[str, list[str]], Verdicts] | None = None
    """Without `command`: the framework's own report about a program with arguments."""
    fixture: str = ""
    """An element that the suite has."""
    name: str = ""
    """For several of a type."""


def built(framework: str, program: str) -> str:
    """A program that `build.sh` has built."""
    return str(BUILDS / framework / program)


def python() -> str:
    """The interpreter of the tests in Python."""
    return os.environ.get("RTF_PYTHON", "python3")


def call_of_pytest(*arguments: str) -> list[str]:
    """A call of pytest."""
    return [python(), "-m", "pytest", *arguments]


def cargo(package: str, test: str) -> list[str]:
    """Runs one test of Rust."""
    manifest = f"--manifest-path={package}/Cargo.toml"
    return ["cargo", "test", "--offline", manifest, "--", "--exact", test]


MASTER = """
  <env name="RTF_PYTHON" value="/usr/bin/python3"/>
  <fixture name="master" type="process">
    <command>roscore -p ${port:ros-master}</command>
    <ready ros-node="/rosout"/>
  </fixture>
"""
CASES = re.findall(r"CASE\((\w+)\)", (HERE / "descendants.hpp").read_text())
CONTINUING = ["forks_and_returns", "forks_and_fails", "needs_a_fork_that_fails"]
"""Their child returns from the case, and continues with the program."""

COMPILED = ["descendants_test", "twice_test"]
PYTEST = str(HERE / "pytest/test_descendants.py")
DEEDS = ["spawns_workers", "forks_and_exits_at_once", "forks_and_aborts"]
DEEDS += ["has_an_environment_of_its_own", "reports_from_a_fork", "passes", "fails"]
WORKERS = [f"test_deed[{deed}]" for deed in DEEDS]
WORKERS += ["test_runs_pytest_in_pytest", "test_runs_pytest_in_a_process"]
"""What works in a worker of pytest-xdist. It has other arguments than pytest, and
threads, so that a forked process can only end."""

SELECTED = " ".join(f"test_descendants.py::{name}" for name in WORKERS)
CORPORA: dict[str, list[Corpus]] = {
    "gtest": [
        Corpus(
            COMPILED,
            [ONE, SEPARATE, AT_MAIN],
            CASES,
            lambda program, case: [built("gtest", program), f"--gtest_filter={case}"],
        )
    ],
    "catch2": [
        Corpus(
            COMPILED,
            [ONE, SEPARATE, AT_MAIN],
            CASES,
            lambda program, case: [built("catch2", program), case],
        )
    ],
    "doctest": [
        Corpus(
            COMPILED,
            [ONE, SEPARATE, AT_MAIN],
            CASES,
            lambda program, case: [built("doctest", program), f"--test-case={case}"],
        )
    ],
    # Its list of cases cannot be printed twice.
    "boost": [
        Corpus(
            COMPILED[:1],
            [ONE, SEPARATE, 'fork="main"'],
            CASES,
            lambda program, case: [built("boost", program), f"--run_test={case}"],
        )
    ],
    "cppunit": [
        Corpus(
            ["descendants_test", "descendants_header_test"],
            [ONE],
            CASES,
            lambda program, case: [built("cppunit", program), case],
        )
    ],
    "pytest": [
        Corpus(
            [PYTEST],
            [ONE, SEPARATE],
            ["test_runs_pytest_in_pytest", "test_deed[passes]", "test_deed[fails]"],
            lambda program, case: call_of_pytest(f"{program}::{case.split('::')[1]}"),
        ),
        Corpus(
            [PYTEST],
            [f'param="-n 2" cases="{SELECTED}"'],
            report=lambda program, args: own_reports.pytest(
                call_of_pytest(*args), [f"{program}::{name}" for name in WORKERS]
            ),
            name="workers-",
        ),
    ],
    "unittest": [
        Corpus(
            [str(HERE / "unittest/test_descendants.py")],
            [ONE, SEPARATE],
            ["test_runs_unittest_in_unittest", "test_passes", "test_fails"],
            lambda _program, case: [python(), "-m", "unittest", "-v", case],
        )
    ],
    "program": [
        Corpus(
            ["descendants_test"],
            [f'param="{name}"' for name in CASES],
            report=lambda program, args: own_reports.program([built("program", program), *args]),
        )
    ],
    # The child and its parent print to one pipe.
    "tap": [
        Corpus(
            ["descendants_test"],
            [
                f'param="tap {" ".join(name for name in CASES if name not in CONTINUING)}"',
                *(f'param="tap {name}"' for name in CONTINUING),
            ],
            report=lambda program, args: own_reports.tap([built("tap", program), *args]),
        )
    ],
    "ctest": [
        Corpus(
            [built("ctest", "descendants")],
            [ONE, SEPARATE],
            CASES,
            report=lambda build, _args: own_reports.ctest(build),
        )
    ],
    "go": [
        Corpus(
            [str(SOURCES / "go/descendants")],
            [ONE, SEPARATE],
            report=lambda package, _args: own_reports.go(package),
        )
    ],
    "aunit": [
        Corpus(
            ["descendants_test"],
            [ONE],
            report=lambda program, _args: own_reports.aunit(built("aunit", program)),
        )
    ],
    "junit": [
        Corpus(
            [built("junit", "descendants")],
            [ONE],
            report=lambda classes, _args: own_reports.junit(classes),
        ),
        # Each virtual machine takes a second.
        Corpus(
            [built("junit", "descendants")],
            [f'{SEPARATE} cases="*.fails() *.reads*()"'],
            report=lambda classes, _args: own_reports.junit(classes, "fails()", "Prints()"),
            name="separate-",
        ),
    ],
    "rostest": [
        Corpus(
            [str(SOURCES / "rostest/arm_tests/descendants.test")],
            [ONE],
            report=lambda launch, _args: own_reports.rostest(launch),
            fixture=MASTER,
        )
    ],
    "cargo": [
        Corpus(
            [str(SOURCES / "cargo/descendants")],
            [ONE, SEPARATE],
            [*CASES, "runs_cargo_in_cargo"],
            lambda package, case: cargo(package, case.partition("::")[2]),
        )
    ],
}


class Trial(NamedTuple):
    """A program in all modes."""

    framework: str
    corpus: Corpus
    program: str
    title: str
    """One of `RUNS`."""


def trials() -> Iterator[ParameterSet]:
    """All programs with all options of rtf."""
    for framework, corpora in CORPORA.items():
        for corpus in corpora:
            # Only the separate cases of programs in C++ are forked.
            is_forked = any("fork=" in mode for mode in corpus.modes)
            for title in list(RUNS) if is_forked else list(RUNS)[:1]:
                for program in corpus.programs:
                    trial = Trial(framework, corpus, program, title)
                    name = f"{corpus.name}{Path(program).name}-{title}"
                    yield parameter(framework, trial, name, "children")


@pytest.mark.parametrize("trial", list(trials()))
def test_verdicts_are_those_without_rtf(
    rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, trial: Trial
) -> None:
    build(trial.framework, monkeypatch)
    tests = run(rtf, trial, tmp_path)
    corpus, program = trial.corpus, trial.program
    verdicts: set[str] = set()
    differences: list[str] = []
    for mode in corpus.modes:
        test = tests[name_of(program, mode)]
        expected = without_rtf(corpus, program, mode, test)
        verdicts |= set(expected.values())
        differences += compare(f"{program} {mode}", corpus, test, expected)
    assert not differences, "\n".join(differences)
    assert {"passed", "failed"} <= verdicts


def test_each_type_has_programs_with_child_processes() -> None:
    # Tests of launch_testing are those of unittest, and `launch_test` cannot run one of them.
    assert sorted([*CORPORA, "launch_testing"]) == TYPES


def run(rtf: str, trial: Trial, directory: Path) -> dict[str, TestResult]:
    """Runs a program in all modes."""
    lines = [
        f'  <test type="{trial.framework}" name={quoteattr(name_of(trial.program, mode))} {mode}>'
        f"{trial.program}</test>"
        for mode in trial.corpus.modes
    ]
    suite = directory / "suite.xml"
    suite.write_text(
        "\n".join(['<suite name="descendants">', trial.corpus.fixture, *lines, "</suite>\n"])
    )
    ours = Run(rtf, str(suite), directory / "results", *RUNS[trial.title])
    ours.wait()
    return observe(ours.events())


def name_of(program: str, mode: str) -> str:
    """The name of a test."""
    return " ".join([Path(program).name, *re.findall(r'"(.*?)"', mode)])


def arguments_of(mode: str) -> str:
    """The `param` of a test."""
    found = re.search(r'param="(.*?)"', mode)
    return found[1] if found else ""


def without_rtf(corpus: Corpus, program: str, mode: str, test: TestResult) -> Verdicts:
    """The verdicts of a program that the framework's own runner runs."""
    if corpus.command is None:
        return report_of(corpus, program, arguments_of(mode))
    return {case: verdict_of(corpus, program, case) for case in test.cases}


@functools.cache
def report_of(corpus: Corpus, program: str, arguments: str) -> Verdicts:
    """The framework's own report about a program."""
    return corpus.report(program, shlex.split(arguments)) if corpus.report else {}


@functools.cache
def verdict_of(corpus: Corpus, program: str, case: str) -> str:
    """The verdict of a case that the framework's own runner runs."""
    assert corpus.command
    done = own_reports.run(
        corpus.command(program, case), str(Path(program).parent if "/" in program else ROOT)
    )
    if done.returncode == 0:
        is_skipped = re.search(r"1 skipped|SKIPPED \] 1 test|skipped=1", done.stdout[-400:])
        return "skipped" if is_skipped else "passed"
    return "failed"


def compare(here: str, corpus: Corpus, test: TestResult, bare: Verdicts) -> list[str]:
    """The differences of a test from the verdicts without rtf."""
    cases = {path: case for path, case in test.cases.items() if case.parent is None}
    is_wrong_outside = bare.get(OUTSIDE, "passed") != "passed"
    differences = [f"outside of cases: {text}" for text in test.messages if not is_wrong_outside]
    names = {re.split(r"\.|::", path)[-1] for path in cases}
    differences += [f"{name} is missing" for name in sorted(set(corpus.names) - names)]
    if corpus.command is not None:
        differences += [f"{path} is no case" for path in cases if "#" in path]
    for path in sorted(cases.keys() | bare.keys() - {OUTSIDE}):
        got, wanted = verdict(cases[path].verdict) if path in cases else "", bare.get(path, "")
        if got != wanted:
            reason = cases[path].reason if path in cases else ""
            differences.append(f"{path}: {got or 'no case'} ({reason}), without rtf {wanted}")
    expected = "failed" if "failed" in bare.values() else "passed"
    if (verdict(test.verdict) if is_wrong_outside else test.verdict) != expected:
        differences.append(f"the test is {test.verdict} ({test.reason}), not {expected}")
    return [f"{here}: {difference}" for difference in differences]


def verdict(ours: str) -> str:
    """A verdict of rtf in the words of the other frameworks."""
    return {"error": "failed", "crashed": "failed"}.get(ours, ours)
