"""Writes suites, runs them with rtf or the predecessor, and checks the results."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterable, Sequence
from pathlib import Path

from measuring.bench import Bench, Launched
from measuring.model import MeasuringError

PREDECESSOR_RESULT = "predecessor.txt"
TOTAL = re.compile(r"^Number of passed test cases +: (\d+)$", re.M)


def write(bench: Bench, name: str, elements: Iterable[str]) -> Path:
    """Writes a suite with these elements to the bench's directory."""
    path = bench.directory / f"{name}.xml"
    body = "\n".join(f"  {element}" for element in elements)
    path.write_text(f'<suite name="{name}">\n{body}\n</suite>\n', encoding="utf-8")
    return path


def tests(kind: str, plugin: str, count: int, isolation: str = "process") -> list[str]:
    """The elements of `count` tests with the same plug-in."""
    attributes = f'type="{kind}" isolation="{isolation}"'
    return [f'<test {attributes} name="test-{n:06}">{plugin}</test>' for n in range(count)]


class Run:
    """A finished run of rtf; its directory is removed at the end of the context."""

    def __init__(
        self,
        bench: Bench,
        suite: Path,
        codes: Sequence[int] = (0,),
        options: Sequence[str] = (),
    ) -> None:
        command = [str(bench.rtf), "run", "--results", str(bench.results), *options, str(suite)]
        self.launched: Launched = bench.launch(command, codes=codes)
        self.directory = (bench.results / "latest").resolve()

    def __enter__(self) -> Run:
        """The run has finished."""
        return self

    def __exit__(self, *problem: object) -> None:
        """Removes the run's directory."""
        shutil.rmtree(self.directory)

    def expect(self, kind: str, count: int, detail: str = "") -> None:
        """Checks that the journal has this many events of a kind."""
        wanted = (f'"type":"{kind}"', detail)
        expect_in(self.directory / "events.jsonl", count, *wanted)

    def events(self) -> list[dict[str, object]]:
        """All events of the journal."""
        with (self.directory / "events.jsonl").open(encoding="utf-8") as journal:
            return [json.loads(line) for line in journal]


def expect_in(file: Path, count: int, *texts: str) -> None:
    """Checks that this many lines of a file contain all of these texts."""
    wanted = [text.encode() for text in texts]
    with file.open("rb") as content:
        found = sum(all(text in line for text in wanted) for line in content)
    if found != count:
        raise MeasuringError(f"{file.name}: {found} lines with `{' '.join(texts)}`, not {count}")


def run_passing(bench: Bench, suite: Path, count: int) -> Launched:
    """Runs a suite in which this many tests must pass."""
    with Run(bench, suite) as run:
        run.expect("test-finished", count, '"verdict":"passed"')
        return run.launched


def run_predecessor(bench: Bench, suite: Path, count: int) -> Launched:
    """The same with the predecessor. Its exit code is 0 even if it loaded no plug-in."""
    old = bench.predecessor
    if old is None:
        raise MeasuringError("the predecessor is missing")
    command = [str(old.runner), "--output", PREDECESSOR_RESULT, "--suite", str(suite)]
    launched = bench.launch(command, settings=old.environment())
    found = TOTAL.search(launched.output)
    if found is None or int(found[1]) != count:
        raise MeasuringError(f"the predecessor did not pass {count} tests:\n{launched.output}")
    return launched
