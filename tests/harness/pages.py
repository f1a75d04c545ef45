"""The files, suites and commands in a page of the guide.

A code block whose first line is a comment with a file name is that file. The commands of an `sh`
block are run, unless a comment `<!-- not run: REASON -->` is above it. A comment `# exit code 1`
at the end of the block is the expected exit code; a `text` block directly below is the expected
output, in which `…` stands for any text.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from checkout import ROOT
from run import Run, expect

_FILE = re.compile(
    r"^```\w+\n((?://|--|#|<!--) (\S+\.\w+)(?:: [^\n]*)?(?: -->)?\n.*?)^```$", re.M | re.S
)
_COMMANDS = re.compile(r"^```sh\n(.*?)^```$", re.M | re.S)
_RUN = re.compile(
    r"(?P<not_run><!-- not run: [^>]+ -->\n)?^```sh\n(?P<text>.*?)^```$"
    r"(?:\n+^```text\n(?P<output>.*?)^```$)?",
    re.M | re.S,
)
_EXIT_CODE = re.compile(r"# exit code (\d+)$")
# What differs in each run: times, names of runs, process ids, ports.
_VARIABLE = re.compile(r"\d+\.\d+ s|\d{4}-\d\d-\d\dT[\d-]+Z-[0-9a-f]{4}|process \d+|port=\d+|…")


@dataclass
class Commands:
    """The commands of one block, their exit code, and their output if the page shows it."""

    text: str
    exit_code: int
    output: str | None

    def matches(self, output: str) -> bool:
        """Whether the page shows this output, apart from times and names of runs."""
        if self.output is None:
            return True
        return re.fullmatch(_pattern(self.output.split()), " ".join(output.split())) is not None


def _pattern(words: list[str]) -> str:
    """A regular expression for an output on a page."""
    text, pattern, position = " ".join(words), "", 0
    for variable in _VARIABLE.finditer(text):
        pattern += re.escape(text[position : variable.start()])
        is_gap = variable.group() == "…"
        pattern += "[^\0]*?" if is_gap else f"(?:{_VARIABLE.pattern})"
        position = variable.end()
    return pattern + re.escape(text[position:])


def commands(page: Path) -> Iterator[Commands]:
    """The commands of a page that are run."""
    for block in _RUN.finditer(page.read_text()):
        if not block["not_run"]:
            code = _EXIT_CODE.search(block["text"].rstrip())
            yield Commands(block["text"], int(code[1]) if code else 0, block["output"])


def write_files(page: Path, directory: Path) -> list[Path]:
    """Writes the files of a page, and returns the suites."""
    suites = []
    shown = set()
    for text, name in _FILE.findall(page.read_text()):
        if name in shown:
            raise AssertionError(f"{page}: {name} is shown twice")
        shown.add(name)
        (directory / name).write_text(text)
        if "<suite " in text:
            suites.append(directory / name)
    if not suites:
        raise AssertionError(f"{page}: no block is a suite: was the page's format changed?")
    return suites


def run_fixture_page(rtf: str, fixture: str, directory: Path, lesson: Path | None = None) -> None:
    """Runs the commands and suites of a fixture's page, the suites next to a lesson's files.

    Tests may fail, because pages show failures, too; fixtures must not collapse.
    """
    page = ROOT / "docs" / "fixtures" / f"{fixture}.md"
    if lesson is None:
        directory.mkdir()
    else:
        shutil.copytree(lesson, directory, ignore=shutil.ignore_patterns("build", "rtf-results"))
    path = f"{Path(rtf).parent}:{os.environ['PATH']}"
    for commands in _COMMANDS.findall(page.read_text()):
        script = ["bash", "-e", "-o", "pipefail", "-c", commands]
        ran = subprocess.run(script, cwd=ROOT, env={**os.environ, "PATH": path}, check=False)
        expect(f"{page.name}: exit code of `{commands.strip()}`", ran.returncode, 0)
    for suite in write_files(page, directory):
        run = Run(rtf, str(suite), directory / f"{suite.stem}.run")
        code = run.wait()
        verdicts = set(run.verdicts().values())
        what = f"{page.name}, {suite.name}: exit code {code}, verdicts {verdicts}"
        expect(what, code in {0, 1} and set() < verdicts <= {"passed", "failed"}, True)
        expect(f"{page.name}: skipped tests", len(list(run.events("test-skipped"))), 0)
        expect(f"{page.name}: collapses", run.reasons(), [])
