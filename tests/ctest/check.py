#!/usr/bin/env python3
"""Runs the CTest tests of suites: one run of a suite has the results for all its tests.

    check.py RTF CMAKE DIRECTORY

CMAKE contains the CMake package `rtf`. The project is built in DIRECTORY.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parents[2]
RESULT = re.compile(r"Test +#\d+: (\S+) \.* *(?:\*\*\*)?([A-Z][A-Za-z ]*?) +[\d.]+ sec")
GREEN = {
    "arm": "Passed",
    "arm/Move": "Passed",
    "arm/Grip": "Passed",
    "arm/Touch": "Passed",
    "arm/Known": "Passed",
    "arm:suite": "Passed",
}
BROKEN = dict.fromkeys(GREEN, "Not Run") | {"arm": "Failed", "arm:suite": "Failed"}

problems: list[str] = []


def check(what: str, got: object, expected: object) -> None:
    """Prints a comparison and keeps a difference."""
    print(f"{'ok' if got == expected else 'DIFFERENT'}: {what}: {got}", flush=True)
    if got != expected:
        problems.append(f"{what}: got {got}, expected {expected}")


class Build:
    """A build directory."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self.printed = ""

    def ctest(self, *arguments: str, **variables: str) -> dict[str, str]:
        """The result of each test that `ctest` starts."""
        for name in ("starts.txt", "parked.txt", "count.txt"):
            (self.directory / name).unlink(missing_ok=True)
        ran = subprocess.run(
            ["ctest", "--output-on-failure", *arguments],
            cwd=self.directory,
            env=os.environ | {"ARM_DIR": str(self.directory)} | variables,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        self.printed = ran.stdout
        print(f"$ ctest {' '.join(arguments)} {variables}\n{ran.stdout}", flush=True)
        return dict(RESULT.findall(ran.stdout))

    def lines(self, name: str) -> int:
        """The number of lines in a file that the fixture or the hook writes."""
        file = self.directory / name
        return len(file.read_text().splitlines()) if file.exists() else 0

    def junit(self) -> tuple[str, ...]:
        """The counts in the report of the last run."""
        root = ElementTree.parse(self.directory / "arm.junit.xml").getroot()
        return tuple(root.attrib[name] for name in ("tests", "failures", "errors", "skipped"))


def main() -> int:
    """Prints all differences; the exit code is 1 if there is any."""
    rtf, cmake, directory = (Path(argument).resolve() for argument in sys.argv[1:4])
    shutil.rmtree(directory, ignore_errors=True)
    project = Path(__file__).parent / "project"
    configure = ["cmake", "-S", str(project), "-B", str(directory), f"-Drtf_DIR={cmake}"]
    subprocess.run(configure, check=True)
    build = Build(directory)
    check_results(build)
    check_selection(build)
    check_suite(build)
    check_no_stale_results(build)
    check_separate_runs(build)
    check_adapter(str(rtf), build)
    for problem in problems:
        print(f"different: {problem}")
    return 1 if problems else 0


def check_results(build: Build) -> None:
    """Each test has its own result, and the suite runs once."""
    check("green", build.ctest("-j4", "-R", "^arm"), GREEN)
    check("starts of the fixture", build.lines("starts.txt"), 1)
    # With a run of the hook; the known failure counts as skipped.
    check("report", build.junit(), ("5", "0", "0", "1"))
    red = {"ARM_MOVE": "fail", "ARM_GRIP": "crash", "ARM_TOUCH": "skip"}
    expected = GREEN | {"arm/Move": "Failed", "arm/Grip": "Failed", "arm/Touch": "Skipped"}
    check("red", build.ctest("-j4", "-R", "^arm", **red), expected)
    check("red report", build.junit(), ("7", "1", "1", "2"))
    for text in ("the arm is bent", "the arm moves", "exit code 3"):
        check(f"`{text}` is printed", text in build.printed, True)


def check_selection(build: Build) -> None:
    """`--rerun-failed` follows the red run; CTest adds the run of the suite to a selection."""
    rerun = dict.fromkeys(("arm", "arm/Move", "arm/Grip", "arm:suite"), "Passed")
    check("rerun", build.ctest("--rerun-failed"), rerun)
    only = dict.fromkeys(("arm", "arm/Grip", "arm:suite"), "Passed")
    check("one test", build.ctest("-R", "^arm/Grip$"), only)
    check("starts for one test", build.lines("starts.txt"), 1)
    by_label = dict.fromkeys(("arm", "arm/Move", "arm:suite"), "Passed")
    check("by label", build.ctest("-R", "^arm/", "-L", "quick"), by_label)


def check_suite(build: Build) -> None:
    """What is no result of a test is red, too."""
    red = build.ctest("-R", "^arm", ARM_MOVE="fail", ARM_PARK="1")
    check("failed hook", red, GREEN | {"arm/Move": "Failed", "arm:suite": "Failed"})
    stopped = build.ctest("-R", "^limited", ARM_GRIP="hang")
    expected = {name.replace("arm", "limited"): result for name, result in BROKEN.items()}
    check("time-out", stopped, expected)
    check("the hook ran after the time-out", build.lines("parked.txt"), 1)
    check("broken suite", build.ctest("-R", "^broken"), {"broken": "Failed"})
    check("its reason", "Missing.lua" in build.printed, True)


def check_no_stale_results(build: Build) -> None:
    """The results of an earlier run are not those of this one."""
    check("killed", build.ctest("-R", "^arm", ARM_GRIP="kill"), BROKEN)
    check("report of the killed run", build.junit(), ("1", "0", "1", "0"))
    check("green after that", build.ctest("-R", "^arm"), GREEN)
    without_run = {"arm/Move": "Failed", "arm:suite": "Failed"}
    check("without the run", build.ctest("-R", "^arm/Move$", "-FS", "."), without_run)
    repeated = build.ctest(
        "-R", "^arm/Move$", "--repeat", "until-fail:3", ARM_MOVE="fail second time"
    )
    check("repeated", repeated.get("arm/Move"), "Failed")
    check("runs until the failure", build.lines("starts.txt"), 2)


def check_separate_runs(build: Build) -> None:
    """With SEPARATE_RUNS, each test is a run with its own fixtures."""
    names = [name.replace("arm/", "separate/") for name in GREEN if "/" in name]
    expected = dict.fromkeys(names, "Passed") | {"separate/Grip": "Failed"}
    check("separate runs", build.ctest("-j2", "-R", "^separate", ARM_GRIP="fail"), expected)
    check("starts in separate runs", build.lines("starts.txt"), 4)


def check_adapter(rtf: str, build: Build) -> None:
    """A suite with a test of type `ctest` runs the same tests."""
    suite = build.directory / "all.xml"
    suite.write_text('<suite><test type="ctest" cases="arm*"> . </test></suite>\n')
    command = [rtf, "run", str(suite)]
    for behaviour, code in (("", 0), ("fail", 1)):
        variables = os.environ | {"ARM_MOVE": behaviour, "ARM_DIR": str(build.directory)}
        ran = subprocess.run(command, cwd=build.directory, env=variables, check=False)
        check(f"rtf run with `{behaviour}`", ran.returncode, code)


if __name__ == "__main__":
    sys.exit(main())
