#!/usr/bin/env python3
"""Counts the instructions of the hot paths and compares them with benches/counts.json.

    tools/counts.py PROGRAM            compare; exit code 1 if one has grown too much
    tools/counts.py PROGRAM --record   write the file

PROGRAM is `rtf-counts`, an optimized build. Callgrind's counts do not depend on other load,
so a slower path is visible even on a busy machine. The counts depend on the compiler and,
slightly, on the C library: the tolerance is small if both are those of the record, and
large otherwise.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NoReturn

RECORD = Path(__file__).resolve().parent.parent / "benches/counts.json"
WORKS = ("plan", "stream", "protocol")
COUNT = re.compile(r"^==\d+== Collected : (\d+)", re.M)
# A larger increase is a regression: with the tools of the record, and with others.
SAME_TOOLS = 0.03
OTHER_TOOLS = 0.25
# A path that became cheaper by more than this should be recorded.
CHEAPER = 0.10


def fail(problem: str) -> NoReturn:
    """Prints an error and exits."""
    sys.exit(f"error: {problem}")


def tools() -> dict[str, str]:
    """The compiler and C library, on which the counts depend."""
    rustc = subprocess.run(["rustc", "--version"], capture_output=True, text=True, check=True)
    name, version = platform.libc_ver()
    library = f"{name} {version}"
    return {"rustc": rustc.stdout.strip(), "libc": library, "machine": platform.machine()}


def count(program: Path, work: str) -> int:
    """The instructions of one workload."""
    with tempfile.TemporaryDirectory() as directory:
        command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
        command += [str(program), work, directory]
        # A fixed environment, address layout and locale.
        environment = {"PATH": os.environ["PATH"], "LC_ALL": "C"}
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, env=environment, check=False
            )
        except FileNotFoundError:
            fail("valgrind is missing\nhint: as root: apt-get install valgrind")
    found = COUNT.search(done.stderr)
    if done.returncode != 0 or found is None:
        fail(f"`{' '.join(command)}` ended with exit code {done.returncode}:\n{done.stderr}")
    return int(found[1])


def compare(counts: dict[str, int], present: dict[str, str]) -> bool:
    """Prints a line per workload; returns whether all are within the tolerance."""
    record = json.loads(RECORD.read_text(encoding="utf-8"))
    is_same = record["tools"] == present
    tolerance = SAME_TOOLS if is_same else OTHER_TOOLS
    if not is_same:
        print(f"recorded with {record['tools']}, counted with {present}")
    good = True
    for work, counted in counts.items():
        recorded = record["counts"].get(work)
        if recorded is None:
            print(f"{work}: {counted:,}, not recorded")
            good = False
            continue
        change = counted / recorded - 1
        holds = change <= tolerance
        note = "" if holds else f"  FAILED: more than {tolerance:+.0%}"
        if change < -CHEAPER:
            note = "  cheaper: `make counts` records it"
        print(f"{work:10} {counted:>14,} instructions, {change:+.2%}{note}")
        good = good and holds
    return good


def main() -> int:
    """Counts, and compares or records."""
    parser = argparse.ArgumentParser(description="instruction counts of the hot paths")
    parser.add_argument("program", type=Path)
    parser.add_argument("--record", action="store_true")
    arguments = parser.parse_args()
    program = arguments.program.resolve()
    if not program.is_file():
        fail(f"`{program}` is missing\nhint: make build")
    counts = {work: count(program, work) for work in WORKS}
    present = tools()
    if arguments.record:
        content = {"tools": present, "counts": counts}
        RECORD.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
        for work, counted in counts.items():
            print(f"{work:10} {counted:>14,} instructions")
        return 0
    if not compare(counts, present):
        print("hint: if this is intended, `make counts` records the new counts")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
