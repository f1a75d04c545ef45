"""Runs GoogleTest's own tests with rtf, and compares each with the report of GoogleTest.

Debian's package googletest has the sources, with tests of every feature, and one program
whose tests fail in every way. They are built once, into the user's cache.
"""

from __future__ import annotations

import fcntl
import os
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

from checkout import call, need_packages
from observed import observe
from run import Run

SOURCE = Path("/usr/src/googletest")
PROGRAMS = [
    "gtest_unittest",
    "googletest-output-test_",
    "googletest-param-test-test",
    "gtest-typed-test_test",
    "gtest_skip_test",
    "googletest-port-test",
    "googletest-message-test",
    "googletest-filepath-test",
    "sample1_unittest",
    "sample6_unittest",
    "sample8_unittest",
]
FEWEST = 500
"""A comparison of no tests would pass."""

OPTIONS = ["-Dgtest_build_tests=ON", "-Dgtest_build_samples=ON", "-DBUILD_GMOCK=OFF"]
WORDS = {"error": "failed", "crashed": "failed"}


def test_googletests_own_tests_have_its_verdicts(rtf: str, tmp_path: Path) -> None:
    need_packages("googletest", "cmake", "g++")
    build = compiled()
    own = {program: run_gtest(build, program, tmp_path) for program in PROGRAMS}
    assert run_rtf(rtf, build, tmp_path) == own
    assert sum(map(len, own.values())) >= FEWEST


def compiled() -> Path:
    """Builds the programs, unless they are in the cache."""
    cache = Path(os.environ.get("CACHE") or Path.home() / ".cache/rtf")
    query = ["dpkg-query", "--show", "--showformat=${Version}", "googletest"]
    version = subprocess.run(query, stdout=subprocess.PIPE, text=True, check=True).stdout
    build = cache / "public" / f"googletest-{version}"
    build.parent.mkdir(parents=True, exist_ok=True)
    with build.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not all((build / "googletest" / program).exists() for program in PROGRAMS):
            call("cmake", "-S", SOURCE, "-B", build, *OPTIONS)
            jobs = str(os.cpu_count() or 1)
            call("cmake", "--build", build, "--parallel", jobs, "--target", *PROGRAMS)
    return build / "googletest"


def run_gtest(build: Path, program: str, directory: Path) -> dict[str, str]:
    """The outcome of each test in the report of GoogleTest.

    Its JSON report is damaged after failures outside of tests (version 1.12).
    """
    report = directory / f"{program}.xml"
    command = [str(build / program), f"--gtest_output=xml:{report}"]
    subprocess.run(command, cwd=directory, stdout=subprocess.DEVNULL, check=False)
    outcomes: dict[str, str] = {}
    for case in ET.parse(report).getroot().iter("testcase"):
        name = f"{case.get('classname')}.{case.get('name')}"
        # rtf gives the second test of a name a number.
        name = f"{name}#2" if name in outcomes else name
        # Failures outside of tests are a case without a name.
        if case.get("name"):
            outcomes[name] = outcome(case)
    return outcomes


def outcome(case: ET.Element) -> str:
    """One word for a test in the report."""
    if case.find("failure") is not None:
        return "failed"
    return "passed" if case.get("result") == "completed" else "skipped"


def run_rtf(rtf: str, build: Path, directory: Path) -> dict[str, dict[str, str]]:
    """The outcome of each case in the journal of rtf, by program."""
    tests = "".join(f'<test type="gtest" name="{it}"> {build / it} </test>' for it in PROGRAMS)
    suite = directory / "suite.xml"
    suite.write_text(f"<suite>{tests}</suite>", encoding="utf-8")
    run = Run(rtf, str(suite), directory / "results")
    run.wait()
    return {
        name: {path: WORDS.get(case.verdict, case.verdict) for path, case in test.cases.items()}
        for name, test in observe(run.events()).items()
    }
