"""robottestingframework-testrunner of 2.x and ours with the same options, see command_lines.py.

An outcome is
`exit code | counts on standard output | the tests in the result file, with their messages`.
"""

from __future__ import annotations

import contextlib
import os
import re
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import pytest
from command_lines import CASES, FILES, REFUSED, Case

NAME = "robottestingframework-testrunner"
SECONDS = 60
# The prefixes of messages in both.
VERBS = re.compile(
    r"^(reports|checks|checking \(false\)|asserts (failure|error) with exception"
    r"|setup\(\) failed!|crashed|interrupted|skipped): "
)


class Runner:
    """One of the two programs."""

    def __init__(self, prefix: Path) -> None:
        """The directory with `bin` and `lib`."""
        self.program = prefix / "bin" / NAME
        self.libraries = ":".join(map(str, sorted(prefix.glob("lib/*-linux-*"))))

    def start(self, options: list[str], directory: Path) -> subprocess.Popen[str]:
        """Starts the program in a directory."""
        environment = os.environ | {"LD_LIBRARY_PATH": self.libraries}
        for name in ("RTF_PLUGIN_PATH", "RTF_RESULTS"):
            environment.pop(name, None)
        return subprocess.Popen(
            [str(self.program), *options],
            cwd=directory,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            stdin=subprocess.DEVNULL,
            text=True,
            errors="replace",
        )

    def run(self, case: Case, directory: Path) -> str:
        """The outcome of a case, in a new directory."""
        directory.mkdir()
        write_files(directory)
        process = self.start(case.options, directory)
        if case.interrupt:
            wait_for(directory / "started")
            process.send_signal(signal.SIGINT)
            # A test that was interrupted ends by itself; another one waits for this file.
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(1)
            (directory / "go").touch()
        stdout, _ = process.communicate(timeout=SECONDS)
        code = "died" if process.returncode < 0 else str(process.returncode)
        result = directory / case.result
        told = outcome(result, case) if result.is_file() else "no file"
        return f"{code} | {counts(stdout)} | {told}"


@pytest.fixture
def runners(predecessor: Path, prefix: Path) -> Iterator[tuple[Runner, Runner]]:
    """2.x and ours."""
    # Shells ignore SIGINT in background processes, and 2.x does not change that.
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield Runner(predecessor), Runner(prefix)
    signal.signal(signal.SIGINT, handler)


@pytest.mark.parametrize("case", CASES, ids=lambda case: " ".join(case.options))
def test_outcome(runners: tuple[Runner, Runner], tmp_path: Path, case: Case) -> None:
    old, new = runners
    expected = (case.old, case.new or case.old)
    assert expected[0] == expected[1] or case.why, "a difference without a reason"
    assert (old.run(case, tmp_path / "old"), new.run(case, tmp_path / "new")) == expected


@pytest.mark.parametrize(
    ("options", "code"), REFUSED, ids=lambda it: " ".join(it) if isinstance(it, list) else it
)
def test_exit_code(
    runners: tuple[Runner, Runner], tmp_path: Path, options: list[str], code: str
) -> None:
    for number, runner in enumerate(runners):
        outcome = runner.run(Case(options, ""), tmp_path / str(number))
        assert outcome.split(" | ", maxsplit=1)[0] == code


def write_files(directory: Path) -> None:
    """Writes the suites and plug-ins of the cases."""
    for name, text in FILES.items():
        file = directory / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    (directory / "empty").mkdir()


def wait_for(file: Path) -> None:
    """Waits until a test has created the file."""
    end = time.monotonic() + SECONDS
    while not file.exists():
        if time.monotonic() > end:
            raise TimeoutError(f"no test created {file.name}")
        os.sched_yield()


def counts(stdout: str) -> str:
    """`suites 2 = 1 + 1, cases 4 = 3 + 1`; total, passed, failed."""
    found = re.findall(r"(?:Total number of|Number of \w+) test (\w+) +: (\d+)", stdout)
    parts = []
    for what in ("suites", "cases"):
        numbers = [number for kind, number in found if kind == what]
        if numbers:
            parts.append(f"{what} {numbers[0]} = {' + '.join(numbers[1:])}")
    return ", ".join(parts) or "no counts"


def outcome(result: Path, case: Case) -> str:
    """The tests of a result file."""
    read = junit if case.options_name("--output-type") == "junit" else text
    tests = read(result.read_text())
    return ", ".join(sorted(tests) if case.in_any_order else tests)


def text(content: str) -> list[str]:
    """`Good passed: [INFO] closed; [FAIL] open` for each test; suites likewise."""
    tests: list[str] = []
    said: list[str] = []
    for line in content.split("\n---------- summary", maxsplit=1)[0].splitlines():
        ended = re.fullmatch(r"Test (case|suite) (.*) (passed|failed)!", line)
        message = re.fullmatch(r"\[(\w+)\] +\([^)]*\) (.*)", line)
        if ended:
            words = f"{plain(ended[2])} {ended[3]}"
            tests.append(": ".join([words, "; ".join(said)] if said else [words]))
            said = []
        elif message:
            words = VERBS.sub("", message[2])
            said.append(f"[{message[1]}] {words}" if len(words) < 200 else f"{len(words)} letters")
    return tests + said


def junit(content: str) -> list[str]:
    """`arm.Bad.lua failure: [FAIL] (Bad.lua) too fast`: class name, result and output."""
    found = []
    for suite in ElementTree.fromstring(content).iter("testsuite"):
        for case in suite.iter("testcase"):
            assert case.get("classname") == f"{suite.get('name')}.{case.get('name')}"
            kinds = [kind for kind in ("failure", "error") if case.find(kind) is not None]
            result = f"{case.get('classname')} {''.join(kinds) or 'passed'}"
            lines = (case.findtext("system-out") or "").splitlines()
            said = [re.fullmatch(r"(\[\w+\]) +(\([^)]*\)) (.*)", line) for line in lines]
            words = [f"{it[1]} {it[2]} {VERBS.sub('', it[3])}" for it in said if it]
            assert len(words) == len(lines), lines
            found.append(": ".join([result, "; ".join(words)] if words else [result]))
    return found


def plain(name: str) -> str:
    """The name in 2.x is the file name; ours has no extension, and `#2` for a second test."""
    return re.sub(r"(\.lua|#[0-9]+)$", "", name)
