#!/usr/bin/env python3
"""Compares speed and memory of rtf with its peers, and judges the results.

The exit code is 1 if a line exceeds its limit, 2 if something could not be measured.
docs/explanation/performance.md explains the lines.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import platform
import re
import signal
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from lines import all_groups
from measuring import table
from measuring.bench import TOP, Bench
from measuring.build import build
from measuring.judge import NOT_MEASURED, Judgement, judge
from measuring.model import Group, MeasuringError
from measuring.others import Others
from measuring.rounds import measure


def main() -> int:
    """Measures, prints, judges."""
    options = parse()
    with tempfile.TemporaryDirectory(prefix="rtf-bench-") as name:
        work = Path(name)
        bench = Bench.open(work, options.results or work / "results", options.rtf.resolve())
        if options.list:
            print_lines(bench)
            return 0
        judgements = list(measure_all(bench, options.only, options.rounds))
        groups = all_groups(bench)
    if not judgements:
        raise MeasuringError(f"no line matches `{options.only.pattern}`, see --list")
    print(about_machine())
    print(table.text(judgements))
    for note in table.notes(judgements):
        print(f"note: {note}")
    if options.json:
        options.json.write_text(table.as_json(judgements), encoding="utf-8")
    if options.page:
        table.write_page(options.page, judgements, groups)
    failed = sum(judgement.fails for judgement in judgements)
    print(f"{failed} of {len(judgements)} lines failed" if failed else "no line failed")
    if any(judgement.verdict == NOT_MEASURED for judgement in judgements):
        return 2
    return 1 if failed else 0


def parse() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n", maxsplit=1)[0])
    parser.add_argument(
        "--only",
        type=re.compile,
        default=re.compile(""),
        metavar="PATTERN",
        help="measure the lines whose group or name matches this regular expression",
    )
    parser.add_argument("--rounds", type=positive, metavar="N", help="instead of each group's")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write all numbers as JSON")
    parser.add_argument("--page", type=Path, metavar="FILE", help="update the rows in this page")
    parser.add_argument("--results", type=Path, metavar="DIR", help="directory for rtf's results")
    parser.add_argument("--rtf", type=Path, default=default_rtf(), help="the rtf to measure")
    parser.add_argument("--list", action="store_true", help="list the lines, measure nothing")
    return parser.parse_args()


def positive(value: str) -> int:
    """A positive number."""
    number = int(value)
    if number < 1:
        raise ValueError(value)
    return number


def default_rtf() -> Path:
    """The result of `make build`."""
    return TOP / os.environ.get("CARGO_TARGET_DIR", "target") / "release" / "rtf"


def print_lines(bench: Bench) -> None:
    """Prints the names of all lines."""
    for group in all_groups(bench):
        for line in group.lines:
            print(f"{group.name}: {line.what}")


def measure_all(bench: Bench, only: re.Pattern[str], rounds: int | None) -> Iterator[Judgement]:
    """Measures each group that has a matching line."""
    build(bench)
    for group in all_groups(bench):
        lines = [line for line in group.lines if only.search(f"{group.name}: {line.what}")]
        if lines:
            try:
                with Progress(group) as report:
                    others = Others()
                    found = measure(group, lines, rounds or group.rounds, report)
                    share = others.share()
            except MeasuringError as problem:
                # The other groups have taken minutes.
                print(f"error: {group.name}: {problem}", file=sys.stderr, flush=True)
                yield from (Judgement(group.name, line, NOT_MEASURED) for line in lines)
                continue
            yield from (replace(judge(group, line, found), foreign_share=share) for line in lines)


class Progress(contextlib.AbstractContextManager["Progress"]):
    """The progress on stderr: one line that is updated, if stderr is a terminal."""

    def __init__(self, group: Group) -> None:
        self.name = group.name
        self.is_terminal = sys.stderr.isatty()

    def __call__(self, what: str) -> None:
        if self.is_terminal:
            print(f"\r\x1b[K{self.name}: {what}", end="", file=sys.stderr, flush=True)

    def __enter__(self) -> Progress:
        """Prints the group's name unless stderr is a terminal."""
        if not self.is_terminal:
            print(f"measuring {self.name}", file=sys.stderr, flush=True)
        return self

    def __exit__(self, *problem: object) -> None:
        """Clears the line."""
        if self.is_terminal:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)


def about_machine() -> str:
    """The system, the number of cores and the load."""
    busy = os.getloadavg()[2]
    cores = os.cpu_count()
    return f"{platform.system()} {platform.machine()}, {cores} cores, load of 15 minutes {busy:.1f}"


if __name__ == "__main__":
    # So that the temporary directory is removed.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    try:
        sys.exit(main())
    except MeasuringError as problem:
        print(f"error: {problem}", file=sys.stderr)
        sys.exit(2)
