#!/usr/bin/env python3
"""Compares the verdicts of programs whose cases start processes, with and without rtf.

    check.py RTF TYPE

`build.sh TYPE` has built the programs, and its exports are set. They run without rtf, where
the framework permits each case alone, and in each isolation mode of rtf. The verdicts of the
cases are the same everywhere, each case is reported once, and nothing is reported outside of
the cases, unless the framework's own report says that something is wrong there.
"""

from __future__ import annotations

import os
import re
import shlex
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import quoteattr

ROOT = Path(__file__).resolve().parents[3]
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(ROOT / "tools"), str(HERE.parent), str(HERE)]

import reports  # noqa: E402
from observed import TestResult, observe  # noqa: E402
from reports import OUTSIDE, Verdicts  # noqa: E402
from run import Run  # noqa: E402

RUNS: dict[str, list[str]] = {"executed": ["--fork", "never"], "forked": []}
"""Options of rtf; the second run is for programs that can be forked."""

ONE = ""
SEPARATE = 'isolation="case"'
AT_MAIN = 'isolation="case" fork="main"'


@dataclass(frozen=True)
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

    def tests(self) -> list[tuple[str, str]]:
        """Programs with the attributes of their tests."""
        return [(program, mode) for program in self.programs for mode in self.modes]


def built(framework: str, program: str) -> str:
    """A program that `build.sh` has built."""
    return str(ROOT / "build/frameworks" / framework / program)


def python() -> str:
    """The interpreter of the tests in Python."""
    return os.environ.get("RTF_PYTHON", "python3")


def pytest(*arguments: str) -> list[str]:
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
            lambda program, case: pytest(f"{program}::{case.split('::')[1]}"),
        ),
        Corpus(
            [PYTEST],
            [f'param="-n 2" cases="{SELECTED}"'],
            report=lambda program, args: reports.pytest(
                pytest(*args), [f"{program}::{name}" for name in WORKERS]
            ),
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
            report=lambda program, args: reports.program([built("program", program), *args]),
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
            report=lambda program, args: reports.tap([built("tap", program), *args]),
        )
    ],
    "ctest": [
        Corpus(
            [built("ctest", "descendants")],
            [ONE, SEPARATE],
            CASES,
            report=lambda build, _args: reports.ctest(build),
        )
    ],
    "go": [
        Corpus(
            [str(HERE.parent / "go/descendants")],
            [ONE, SEPARATE],
            report=lambda package, _args: reports.go(package),
        )
    ],
    "aunit": [
        Corpus(
            ["descendants_test"],
            [ONE],
            report=lambda program, _args: reports.aunit(built("aunit", program)),
        )
    ],
    "junit": [
        Corpus(
            [built("junit", "descendants")],
            [ONE],
            report=lambda classes, _args: reports.junit(classes),
        ),
        # Each virtual machine takes a second.
        Corpus(
            [built("junit", "descendants")],
            [f'{SEPARATE} cases="*.fails() *.reads*()"'],
            report=lambda classes, _args: reports.junit(classes, "fails()", "Prints()"),
        ),
    ],
    "rostest": [
        Corpus(
            [str(HERE.parent / "rostest/arm_tests/descendants.test")],
            [ONE],
            report=lambda launch, _args: reports.rostest(launch),
            fixture=MASTER,
        )
    ],
    "cargo": [
        Corpus(
            [str(HERE.parent / "cargo/descendants")],
            [ONE, SEPARATE],
            [*CASES, "runs_cargo_in_cargo"],
            lambda package, case: cargo(package, case.partition("::")[2]),
        )
    ],
}


def main() -> int:
    """Prints all differences; the exit code is 1 if there is any."""
    rtf, framework = str(Path(sys.argv[1]).resolve()), sys.argv[2]
    differences: list[str] = []
    verdicts: list[str] = []
    for corpus in CORPORA[framework]:
        # By program and arguments.
        bare: dict[tuple[str, str], Verdicts] = {}
        # Only the separate cases of programs in C++ are forked.
        is_forked = any("fork=" in mode for mode in corpus.modes)
        for title in list(RUNS) if is_forked else list(RUNS)[:1]:
            with tempfile.TemporaryDirectory() as name:
                tests = run(rtf, framework, corpus, Path(name), RUNS[title])
            for program, mode in corpus.tests():
                test = tests[name_of(program, mode)]
                known = bare.setdefault((program, arguments_of(mode)), {})
                expected = without_rtf(corpus, program, mode, test, known)
                differences += compare(f"{title}: {program} {mode}", corpus, test, expected)
        verdicts += [verdict for each in bare.values() for verdict in each.values()]
    print(f"\n{len(verdicts)} cases, {len(differences)} differences")
    for difference in differences:
        print(f"different: {difference}")
    return 1 if differences or not {"passed", "failed"} <= set(verdicts) else 0


def run(
    rtf: str, framework: str, corpus: Corpus, directory: Path, options: list[str]
) -> dict[str, TestResult]:
    """Runs the programs in all modes."""
    lines = [
        f'  <test type="{framework}" name={quoteattr(name_of(program, mode))} {mode}>'
        f"{program}</test>"
        for program, mode in corpus.tests()
    ]
    suite = directory / "suite.xml"
    suite.write_text(
        "\n".join(['<suite name="descendants">', corpus.fixture, *lines, "</suite>\n"])
    )
    ours = Run(rtf, str(suite), directory / "results", *options)
    ours.wait()
    return observe(ours.events())


def name_of(program: str, mode: str) -> str:
    """The name of a test."""
    return " ".join([Path(program).name, *re.findall(r'"(.*?)"', mode)])


def arguments_of(mode: str) -> str:
    """The `param` of a test."""
    found = re.search(r'param="(.*?)"', mode)
    return found[1] if found else ""


def without_rtf(
    corpus: Corpus, program: str, mode: str, test: TestResult, known: Verdicts
) -> Verdicts:
    """The verdicts of a program that the framework's own runner runs; `known` remembers them."""
    if corpus.command is None and corpus.report is not None and not known:
        known |= corpus.report(program, shlex.split(arguments_of(mode)))
    if corpus.command is None:
        return known
    for case in test.cases.keys() - known.keys():
        known[case] = verdict_of(corpus.command(program, case), program)
    return {case: known[case] for case in test.cases}


def verdict_of(command: list[str], program: str) -> str:
    """The verdict of a case that the framework's own runner runs."""
    done = reports.run(command, str(Path(program).parent if "/" in program else ROOT))
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


if __name__ == "__main__":
    sys.exit(main())
