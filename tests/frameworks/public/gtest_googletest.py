#!/usr/bin/env python3
"""Runs GoogleTest's own tests with rtf, and compares each with the report of GoogleTest.

    gtest_googletest.py RTF

Debian's package googletest has the sources, with tests of every feature, and one program
whose tests fail in every way. They are built once, into the user's cache.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests/frameworks")]

from observed import observe  # noqa: E402
from run import Run  # noqa: E402

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


def main() -> int:
    """Prints all differences; the exit code is 1 if there is any."""
    rtf = str(Path(sys.argv[1]).resolve())
    build = compiled()
    with tempfile.TemporaryDirectory() as directory:
        own = {program: run_gtest(build, program, Path(directory)) for program in PROGRAMS}
        ours = run_rtf(rtf, build, Path(directory))
    count = different = 0
    for program in PROGRAMS:
        got, expected = ours.get(program, {}), own[program]
        for name in sorted(got.keys() | expected.keys()):
            count += 1
            if got.get(name) != expected.get(name):
                different += 1
                outcomes = f"gtest {expected.get(name)}, rtf {got.get(name)}"
                print(f"different: {program}: {name}: {outcomes}")
    if count < FEWEST:
        print(f"GoogleTest ran only {count} tests, expected {FEWEST}")
        return 1
    print(f"{count - different} passed, {different} failed")
    return 1 if different else 0


def compiled() -> Path:
    """Builds the programs, unless they are in the cache."""
    cache = Path(os.environ.get("CACHE") or Path.home() / ".cache/rtf")
    query = ["dpkg-query", "--show", "--showformat=${Version}", "googletest"]
    version = subprocess.run(query, stdout=subprocess.PIPE, text=True, check=True).stdout
    build = cache / "public" / f"googletest-{version}"
    if all((build / "googletest" / program).exists() for program in PROGRAMS):
        return build / "googletest"
    subprocess.run(["cmake", "-S", str(SOURCE), "-B", str(build), *OPTIONS], check=True)
    jobs = str(os.cpu_count() or 1)
    command = ["cmake", "--build", str(build), "--parallel", jobs, "--target", *PROGRAMS]
    subprocess.run(command, check=True)
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


if __name__ == "__main__":
    sys.exit(main())
