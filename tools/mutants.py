#!/usr/bin/env python3
"""Changes the code that judges, and counts which changes the tests notice, with cargo-mutants.

    mutants.py [PART ...] [-- OPTION ...]

Prints a row for each part and the changes that no test noticed. The exit code is 1 if fewer than
the goal were noticed. The results are in build/mutants.
"""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "mutants"
GOAL = 90.0


@dataclass
class Part:
    """A part of the code, and the arguments of `cargo test` for its tests."""

    files: list[str]
    tests: list[str]


PARTS = {
    "judge": Part(["crates/rtf-engine/src/run/machine/judge.rs"], ["--package=rtf-engine"]),
    "order": Part(["crates/rtf-model/src/order.rs"], ["--package=rtf-model"]),
    "record": Part(["crates/rtf-model/src/record/*.rs"], ["--package=rtf-model"]),
    "filter": Part(["crates/rtf-plan/src/select/filter.rs"], ["--package=rtf-plan"]),
    "statistics": Part(["crates/rtf-statistics/src/**/*.rs"], ["--package=rtf-statistics"]),
}


def main() -> int:
    """Runs the parts."""
    words = sys.argv[1:]
    split = words.index("--") if "--" in words else len(words)
    names, options = words[:split] or list(PARTS), words[split + 1 :]
    unknown = [name for name in names if name not in PARTS]
    if unknown:
        raise SystemExit(f"error: no part {', '.join(unknown)}; there are {', '.join(PARTS)}")
    results = {name: run(name, options) for name in names}
    print("| part | changes | noticed | |\n| --- | ---: | ---: | ---: |")
    for name, found in results.items():
        total, noticed = found.total(), found.noticed
        print(f"| {name} | {total} | {noticed} | {found.share():.1f} % |")
    for name, found in results.items():
        for change in found.missed:
            print(f"{name}: {change}")
    return 1 if any(found.share() < GOAL for found in results.values()) else 0


@dataclass
class Found:
    """The changes that compile."""

    noticed: int
    missed: list[str]

    def total(self) -> int:
        """All of them."""
        return self.noticed + len(self.missed)

    def share(self) -> float:
        """The noticed ones in percent."""
        return 100 * self.noticed / max(self.total(), 1)


def run(name: str, options: list[str]) -> Found:
    """Runs cargo-mutants for a part."""
    part, output = PARTS[name], BUILD / name
    output.mkdir(parents=True, exist_ok=True)
    command = ["cargo", "mutants", "--output", str(output), "--no-shuffle", "--colors=never"]
    command += [f"--file={file}" for file in part.files]
    command += [*part.tests, *options]
    ended = subprocess.run(command, cwd=ROOT, stdout=sys.stderr, check=False)
    # 2: some were not noticed, 3: some took too long.
    if ended.returncode not in (0, 2, 3):
        raise SystemExit(f"error: cargo-mutants failed with exit code {ended.returncode}")
    outcomes = json.loads((output / "mutants.out" / "outcomes.json").read_text(encoding="utf-8"))
    return Found(
        noticed=outcomes["caught"] + outcomes["timeout"],
        missed=(output / "mutants.out" / "missed.txt").read_text(encoding="utf-8").splitlines(),
    )


if __name__ == "__main__":
    sys.exit(main())
