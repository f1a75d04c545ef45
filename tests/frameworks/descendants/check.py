#!/usr/bin/env python3
"""Compares the verdicts of programs whose cases start processes, with and without rtf.

    check.py RTF TYPE

`build.sh TYPE` has built the programs, and its exports are set. Each case runs alone without
rtf, and in each isolation mode of rtf. Its verdict is the same everywhere, each case is
reported once, and nothing is reported outside of the cases.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import quoteattr

ROOT = Path(__file__).resolve().parents[3]
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(ROOT / "tools"), str(HERE.parent)]

from observed import TestResult, observe  # noqa: E402
from run import Run  # noqa: E402

SECONDS = 120
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
    command: Callable[[str, str], list[str]]
    """Runs one case of a program without rtf."""


def built(framework: str, program: str) -> str:
    """A program that `build.sh` has built."""
    return str(ROOT / "build/frameworks" / framework / program)


def python() -> str:
    """The interpreter of the tests in Python."""
    return os.environ.get("RTF_PYTHON", "python3")


COMPILED = ["descendants_test", "twice_test"]
CORPORA = {
    "gtest": Corpus(
        COMPILED,
        [ONE, SEPARATE, AT_MAIN],
        lambda program, case: [built("gtest", program), f"--gtest_filter={case}"],
    ),
    "catch2": Corpus(
        COMPILED,
        [ONE, SEPARATE, AT_MAIN],
        lambda program, case: [built("catch2", program), case],
    ),
    "doctest": Corpus(
        COMPILED,
        [ONE, SEPARATE, AT_MAIN],
        lambda program, case: [built("doctest", program), f"--test-case={case}"],
    ),
    # Its list of cases cannot be printed twice.
    "boost": Corpus(
        COMPILED[:1],
        [ONE, SEPARATE, 'fork="main"'],
        lambda program, case: [built("boost", program), f"--run_test={case}"],
    ),
    "cppunit": Corpus(
        ["descendants_test", "descendants_header_test"],
        [ONE],
        lambda program, case: [built("cppunit", program), case],
    ),
    "pytest": Corpus(
        [str(HERE / "pytest/test_descendants.py")],
        [ONE, SEPARATE],
        lambda program, case: [python(), "-m", "pytest", f"{program}::{case.split('::')[1]}"],
    ),
    "unittest": Corpus(
        [str(HERE / "unittest/test_descendants.py")],
        [ONE, SEPARATE],
        lambda _program, case: [python(), "-m", "unittest", "-v", case],
    ),
}


def main() -> int:
    """Prints all differences; the exit code is 1 if there is any."""
    rtf, framework = str(Path(sys.argv[1]).resolve()), sys.argv[2]
    corpus = CORPORA.get(framework)
    if corpus is None:
        print(f"no programs of {framework} start processes")
        return 0
    differences: list[str] = []
    bare: dict[tuple[str, str], str] = {}
    with tempfile.TemporaryDirectory() as name:
        # Only the separate cases of programs in C++ are forked.
        is_forked = any("fork=" in mode for mode in corpus.modes)
        titles = list(RUNS) if is_forked else list(RUNS)[:1]
        for title in titles:
            options = RUNS[title]
            tests = run(rtf, framework, Path(name) / title, options)
            for program in corpus.programs:
                for mode in corpus.modes:
                    test = tests[name_of(program, mode)]
                    here = f"{title}: {program} {mode}"
                    for path in test.cases:
                        if (program, path) not in bare:
                            bare[program, path] = verdict_without(corpus, program, path)
                    expected = {path: bare[program, path] for path in test.cases}
                    differences += compare(here, test, expected)
    print(f"\n{len(bare)} cases, {len(differences)} differences")
    for difference in differences:
        print(f"different: {difference}")
    return 1 if differences or not bare else 0


def run(rtf: str, framework: str, directory: Path, options: list[str]) -> dict[str, TestResult]:
    """Runs the programs in all modes."""
    corpus = CORPORA[framework]
    lines = [
        f'  <test type="{framework}" name={quoteattr(name_of(program, mode))} {mode}>'
        f"{program}</test>"
        for program in corpus.programs
        for mode in corpus.modes
    ]
    suite = directory.with_suffix(".xml")
    suite.write_text("\n".join(['<suite name="descendants">', *lines, "</suite>\n"]))
    ours = Run(rtf, str(suite), directory, *options)
    ours.wait()
    return observe(ours.events())


def name_of(program: str, mode: str) -> str:
    """The name of a test."""
    return " ".join([Path(program).name, *re.findall(r'"(.*?)"', mode)])


def verdict_without(corpus: Corpus, program: str, case: str) -> str:
    """The verdict of a case that the framework's own runner runs."""
    done = subprocess.run(
        corpus.command(program, case),
        cwd=Path(program).parent if "/" in program else ROOT,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        timeout=SECONDS,
        env={**os.environ, "PYTHONPATH": str(ROOT / "sdk/python")},
        check=False,
    )
    if done.returncode == 0:
        is_skipped = re.search(r"1 skipped|SKIPPED \] 1 test|skipped=1", done.stdout[-400:])
        return "skipped" if is_skipped else "passed"
    return "failed"


def compare(here: str, test: TestResult, bare: dict[str, str]) -> list[str]:
    """The differences of a test from the verdicts without rtf."""
    differences = [f"{here}: outside of cases: {text}" for text in test.messages]
    names = required(here) - {path.rpartition(".")[2].rpartition("::")[2] for path in test.cases}
    differences += [f"{here}: {name} is missing" for name in sorted(names)]
    differences += [f"{here}: {path} is no case" for path in test.cases if "#" in path]
    for path, case in test.cases.items():
        got = {"error": "failed", "crashed": "failed"}.get(case.verdict, case.verdict)
        if got != bare[path]:
            differences.append(f"{here}: {path}: {got} ({case.reason}), without rtf {bare[path]}")
    expected = "failed" if "failed" in bare.values() else "passed"
    if test.verdict != expected:
        differences.append(f"{here}: the test is {test.verdict} ({test.reason}), not {expected}")
    return differences


def required(here: str) -> set[str]:
    """The names of cases that each program has."""
    if "/pytest/" in here:
        return {"test_runs_pytest_in_pytest", "test_deed[passes]", "test_deed[fails]"}
    if "/unittest/" in here:
        return {"test_runs_unittest_in_unittest", "test_passes", "test_fails"}
    text = (HERE / "descendants.hpp").read_text()
    return set(re.findall(r"CASE\((\w+)\)", text))


if __name__ == "__main__":
    sys.exit(main())
