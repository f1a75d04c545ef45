#!/usr/bin/env python3
"""Changes the code that judges, and counts which changes the tests notice, with cargo-mutants.

    mutants.py [PART ...] [-- OPTION ...]

Prints a row for each part and the changes that no test noticed. The exit code is 1 if fewer than
the goal were noticed. The results are in build/mutants.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "mutants"
GOAL = 90.0


@dataclass
class Part:
    """A part of the code, and the crates with its tests.

    The tests of a further crate run only for changes that those of the crates before it did not
    notice.
    """

    files: str
    crates: list[str]


PARTS = {
    "judge": Part("crates/rtf-engine/src/run/machine/judge.rs", ["rtf-engine"]),
    "order": Part("crates/rtf-model/src/order.rs", ["rtf-model"]),
    "record": Part("crates/rtf-model/src/record/*.rs", ["rtf-model"]),
    "filter": Part("crates/rtf-plan/src/select/filter.rs", ["rtf-plan"]),
    "statistics": Part("crates/rtf-statistics/src/**/*.rs", ["rtf-statistics", "rtf-campaign"]),
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
    # An earlier run would be continued.
    shutil.rmtree(output, ignore_errors=True)
    output.mkdir(parents=True)
    command = ["cargo", "mutants", "--output", str(output), "--no-shuffle", "--colors=never"]
    command += [f"--file={part.files}", *options]
    first, *further = part.crates
    found = run_tests([*command, f"--test-package={first}"], output)
    total = found.total()
    for crate in further:
        if found.missed:
            found = run_tests([*command, f"--test-package={crate}", "--iterate"], output)
    return Found(total - len(found.missed), found.missed)


def run_tests(command: list[str], output: Path) -> Found:
    """Runs cargo-mutants once."""
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
