"""Runs the CTest tests of suites: one run of a suite has the results for all its tests."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest
from checkout import ROOT, call
from run import expect

pytestmark = pytest.mark.usefixtures("rtf")
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


@pytest.fixture
def build(tmp_path: Path) -> Build:
    """A configured project."""
    call(
        "cmake",
        "-S",
        Path(__file__).parent / "project",
        "-B",
        tmp_path,
        f"-Drtf_DIR={ROOT}/sdk/cpp/cmake/rtf",
    )
    return Build(tmp_path)


def test_each_test_has_its_own_result_and_the_suite_runs_once(build: Build) -> None:
    """Each test has its own result, and the suite runs once."""
    expect("green", build.ctest("-j4", "-R", "^arm"), GREEN)
    expect("starts of the fixture", build.lines("starts.txt"), 1)
    # With a run of the hook; the known failure counts as skipped.
    expect("report", build.junit(), ("5", "0", "0", "1"))
    red = {"ARM_MOVE": "fail", "ARM_GRIP": "crash", "ARM_TOUCH": "skip"}
    expected = GREEN | {"arm/Move": "Failed", "arm/Grip": "Failed", "arm/Touch": "Skipped"}
    expect("red", build.ctest("-j4", "-R", "^arm", **red), expected)
    expect("red report", build.junit(), ("7", "1", "1", "2"))
    for text in ("the arm is bent", "the arm moves", "exit code 3"):
        expect(f"`{text}` is printed", text in build.printed, True)


def test_ctest_adds_the_run_of_the_suite_to_a_selection(build: Build) -> None:
    build.ctest("-j4", "-R", "^arm", ARM_MOVE="fail", ARM_GRIP="crash", ARM_TOUCH="skip")
    rerun = dict.fromkeys(("arm", "arm/Move", "arm/Grip", "arm:suite"), "Passed")
    expect("rerun", build.ctest("--rerun-failed"), rerun)
    only = dict.fromkeys(("arm", "arm/Grip", "arm:suite"), "Passed")
    expect("one test", build.ctest("-R", "^arm/Grip$"), only)
    expect("starts for one test", build.lines("starts.txt"), 1)
    by_label = dict.fromkeys(("arm", "arm/Move", "arm:suite"), "Passed")
    expect("by label", build.ctest("-R", "^arm/", "-L", "quick"), by_label)


def test_what_is_no_result_of_a_test_is_red(build: Build) -> None:
    """What is no result of a test is red, too."""
    red = build.ctest("-R", "^arm", ARM_MOVE="fail", ARM_PARK="1")
    expect("failed hook", red, GREEN | {"arm/Move": "Failed", "arm:suite": "Failed"})
    stopped = build.ctest("-R", "^limited", ARM_GRIP="hang")
    expected = {name.replace("arm", "limited"): result for name, result in BROKEN.items()}
    expect("time-out", stopped, expected)
    expect("the hook ran after the time-out", build.lines("parked.txt"), 1)
    expect("broken suite", build.ctest("-R", "^broken"), {"broken": "Failed"})
    expect("its reason", "Missing.lua" in build.printed, True)


def test_results_of_an_earlier_run_are_not_those_of_this_one(build: Build) -> None:
    """The results of an earlier run are not those of this one."""
    build.ctest("-R", "^arm")
    expect("killed", build.ctest("-R", "^arm", ARM_GRIP="kill"), BROKEN)
    expect("report of the killed run", build.junit(), ("1", "0", "1", "0"))
    expect("green after that", build.ctest("-R", "^arm"), GREEN)
    without_run = {"arm/Move": "Failed", "arm:suite": "Failed"}
    expect("without the run", build.ctest("-R", "^arm/Move$", "-FS", "."), without_run)
    repeated = build.ctest(
        "-R", "^arm/Move$", "--repeat", "until-fail:3", ARM_MOVE="fail second time"
    )
    expect("repeated", repeated.get("arm/Move"), "Failed")
    expect("runs until the failure", build.lines("starts.txt"), 2)


def test_a_test_with_separate_runs_has_its_own_fixtures(build: Build) -> None:
    """With SEPARATE_RUNS, each test is a run with its own fixtures."""
    names = [name.replace("arm/", "separate/") for name in GREEN if "/" in name]
    expected = dict.fromkeys(names, "Passed") | {"separate/Grip": "Failed"}
    expect("separate runs", build.ctest("-j2", "-R", "^separate", ARM_GRIP="fail"), expected)
    expect("starts in separate runs", build.lines("starts.txt"), 4)


def test_a_suite_of_type_ctest_runs_the_same_tests(rtf: str, build: Build) -> None:
    """A suite with a test of type `ctest` runs the same tests."""
    suite = build.directory / "all.xml"
    suite.write_text('<suite><test type="ctest" cases="arm*"> . </test></suite>\n')
    command = [rtf, "run", str(suite)]
    for behaviour, code in (("", 0), ("fail", 1)):
        variables = os.environ | {"ARM_MOVE": behaviour, "ARM_DIR": str(build.directory)}
        ran = subprocess.run(command, cwd=build.directory, env=variables, check=False)
        expect(f"rtf run with `{behaviour}`", ran.returncode, code)
