#!/usr/bin/env python3
"""Every test that SECURITY.md names exists.

A promise names tests as "`name` in `file`": a function with the attribute of a test, or a fuzz
target.
"""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TARGETS = ROOT / "crates/rtf-fuzz/src/targets/mod.rs"
ROW = re.compile(r"^\| (?P<promise>[^|]+) \| (?P<tests>[^|]+) \|$", re.M)
NAMED = re.compile(r"`([^`]+)` in `([^`]+)`")


def main() -> None:
    """Prints the promises whose tests are missing."""
    text = (ROOT / "SECURITY.md").read_text(encoding="utf-8")
    problems, promises = [], 0
    # The tables of attackers have three columns.
    for row in ROW.finditer(text):
        promise, tests = row["promise"], NAMED.findall(row["tests"])
        if promise in ("promise", "---"):
            continue
        promises += 1
        if not tests:
            problems.append(f"no test: {promise}")
        problems += [
            f"{file} has no test `{name}`" for name, file in tests if not exists(name, file)
        ]
    if problems or not promises:
        raise SystemExit("\n".join(["SECURITY.md:", *problems]))
    print(f"{promises} promises have tests")


def exists(name: str, file: str) -> bool:
    """Whether a file has this test, or there is a fuzz target of this name."""
    path = ROOT / file
    if not path.is_file():
        return False
    if path.is_relative_to(TARGETS.parent):
        return f'name: "{name}"' in TARGETS.read_text(encoding="utf-8")
    pattern = rf"#\[(?:tokio::)?test\]\n(?:\s*(?:#\[|///).*\n)*\s*(?:async )?fn {name}\("
    return re.search(pattern, path.read_text(encoding="utf-8")) is not None


if __name__ == "__main__":
    main()
