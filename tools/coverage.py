#!/usr/bin/env python3
"""Prints the covered lines of each crate, from the summary of `cargo llvm-cov` on standard input.

The exit code is 1 if a crate of the core has less than its goal.
"""

from __future__ import annotations

import json
import sys
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
GOAL = 90.0
CORE = {"rtf-model", "rtf-plan", "rtf-engine", "rtf-monitor"}


def main() -> int:
    """Prints a table of Markdown."""
    [summary] = json.load(sys.stdin)["data"]
    lines: dict[str, list[int]] = defaultdict(lambda: [0, 0])
    for file in summary["files"]:
        path = Path(file["filename"])
        if path.is_relative_to(ROOT / "crates"):
            crate = path.relative_to(ROOT / "crates").parts[0]
            lines[crate][0] += file["summary"]["lines"]["covered"]
            lines[crate][1] += file["summary"]["lines"]["count"]
    print("| crate | lines | covered | goal |\n| --- | ---: | ---: | ---: |")
    missed = False
    for crate, (covered, count) in sorted(lines.items()):
        share = 100 * covered / max(count, 1)
        goal = f"{GOAL:.0f} %" if crate in CORE else ""
        missed = missed or (crate in CORE and share < GOAL)
        print(f"| `{crate}` | {count} | {share:.1f} % | {goal} |")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
