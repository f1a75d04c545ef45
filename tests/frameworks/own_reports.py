"""The verdicts that frameworks themselves report about the programs in `descendants`."""

from __future__ import annotations

import json
import os
import re
import subprocess
import tempfile
from collections import Counter
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

from checkout import ROOT

SECONDS = 120

Verdicts = dict[str, str]
"""By case. What is outside of the cases has the name `OUTSIDE`."""

OUTSIDE = ""

RESULTS = {"OK": "passed", "FAIL": "failed", "ERROR": "failed"}
"""In the words of AUnit."""

TAP_PARSER = r"""
my $tap = TAP::Parser->new({exec => \@ARGV});
while (my $line = $tap->next) {
    printf "%s\t%s\n", $line->is_actual_ok ? "ok" : "failed", $line->description if $line->is_test;
}
print "failed\t\n" if $tap->parse_errors or $tap->exit && !$tap->failed;
"""
"""The parser of `prove` prints each test, and one without a name for other problems, also for a
number that occurs twice."""


def program(command: list[str]) -> Verdicts:
    """The exit code of a program."""
    return {OUTSIDE: "failed" if run(command).returncode else "passed"}


def tap(command: list[str]) -> Verdicts:
    """The tests of a program, as `prove` reads them; the second one with a name is `NAME#2`."""
    verdicts: Verdicts = {}
    names: Counter[str] = Counter()
    for line in run(["perl", "-MTAP::Parser", "-e", TAP_PARSER, *command]).stdout.splitlines():
        result, _, name = line.partition("\t")
        name = name.removeprefix("- ")
        names[name] += 1
        add(verdicts, name if names[name] == 1 else f"{name}#{names[name]}", result != "ok")
    return verdicts


def ctest(build: str) -> Verdicts:
    """The tests of a build directory."""
    with tempfile.TemporaryDirectory() as directory:
        file = Path(directory) / "junit.xml"
        run(["ctest", "--test-dir", build, "--output-junit", str(file)])
        return junit_file(file, "{name}")


def pytest(command: list[str], cases: list[str]) -> Verdicts:
    """Cases of one file."""
    with tempfile.TemporaryDirectory() as directory:
        file = Path(directory) / "junit.xml"
        run([*command, f"--junit-xml={file}", *cases], str(Path(cases[0]).parent))
        return junit_file(file, "{classname}.py::{name}")


def aunit(program: str) -> Verdicts:
    """The tests of a program, whose own list is its last one."""
    output = run([program]).stdout
    lines = re.findall("^(OK|FAIL|ERROR) (Descendants) : (.*)$", output, re.MULTILINE)
    return {f"{case}: {name}": RESULTS[result] for result, case, name in lines}


def go(package: str) -> Verdicts:
    """The tests of a package."""
    verdicts: Verdicts = {}
    for line in run(["go", "test", "-json", "-count=1"], package).stdout.splitlines():
        event = json.loads(line)
        if event["Action"] in ("pass", "fail") and "Test" in event:
            add(verdicts, event["Test"], event["Action"] == "fail")
    return verdicts


def junit(classes: str, *ends: str) -> Verdicts:
    """The tests of a directory of classes, or those whose names end so."""
    verdicts = all_of_junit(classes)
    return {name: it for name, it in verdicts.items() if not ends or name.endswith(ends)}


@cache
def all_of_junit(classes: str) -> Verdicts:
    """The tests of a directory of classes."""
    with tempfile.TemporaryDirectory() as directory:
        launcher = ["java", "-jar", os.environ["RTF_JUNIT"], "execute", "--scan-class-path"]
        run([*launcher, f"--class-path={classes}", f"--reports-dir={directory}"])
        file = Path(directory) / "TEST-junit-jupiter.xml"
        return junit_file(file, "{classname}.{name}")


def rostest(launch: str) -> Verdicts:
    """The tests of a node, which rostest runs on a master of its own."""
    with tempfile.TemporaryDirectory() as home:
        run(["rostest", launch], ROS_HOME=home, ROS_LOG_DIR=f"{home}/log", ROS_IP="127.0.0.1")
        node = Path(launch).stem
        file = Path(home) / f"test_results/{Path(launch).parent.name}/rosunit-{node}.xml"
        verdicts = junit_file(file, node + ".{classname}.{name}")
        return {name.replace(".__main__.", "."): verdict for name, verdict in verdicts.items()}


def junit_file(file: Path, name: str) -> Verdicts:
    """The test cases of a file; `name` is composed of their attributes."""
    verdicts: Verdicts = {}
    for case in ElementTree.parse(file).iter("testcase"):
        has_problem = any(child.tag in ("failure", "error") for child in case)
        add(verdicts, name.format(**case.attrib), has_problem)
    return verdicts


def add(verdicts: Verdicts, name: str, has_failed: bool) -> None:
    """Adds a result; of several ones, the worst counts."""
    if has_failed or name not in verdicts:
        verdicts[name] = "failed" if has_failed else "passed"


def run(
    command: list[str], directory: str = str(ROOT), **variables: str
) -> subprocess.CompletedProcess[str]:
    """Runs a program without rtf."""
    return subprocess.run(
        command,
        cwd=directory,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        timeout=SECONDS,
        env={**os.environ, "PYTHONPATH": str(ROOT / "sdk/python"), **variables},
        check=False,
    )
