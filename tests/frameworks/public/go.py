#!/usr/bin/env python3
"""Compares rtf with `go test` case by case.

go.py RTF DIRECTORY    the directory of a Go package
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests/frameworks")]

from observed import observe  # noqa: E402
from run import Run  # noqa: E402

VERDICTS = {"pass": "passed", "fail": "failed", "skip": "skipped"}
AT_LEAST = 100


def main() -> int:
    """Prints all differences; the exit code is 1 if there is any."""
    rtf, package = sys.argv[1], Path(sys.argv[2])
    expected = results_of_go(package)
    with tempfile.TemporaryDirectory() as name:
        suite = str(Path(__file__).with_name("go.xml"))
        run = Run(str(Path(rtf).resolve()), suite, Path(name) / "results")
        code = run.wait()
        test = observe(run.events())["pflag"]
    got = {path: case.verdict for path, case in test.cases.items()}
    differences = [
        f"{path}: got {got.get(path)}, expected {expected.get(path)}"
        for path in sorted(got.keys() | expected.keys())
        if got.get(path) != expected.get(path)
    ]
    is_green = all(verdict != "failed" for verdict in expected.values())
    if (code == 0) != is_green:
        differences.append(f"exit code: got {code}")
    if len(expected) < AT_LEAST:
        differences.append(f"`go test` ran only {len(expected)} tests")
    for difference in differences:
        print(f"different: {difference}")
    print(f"{len(expected)} tests of `go test`, {len(differences)} differences")
    return 1 if differences else 0


def results_of_go(package: Path) -> dict[str, str]:
    """The verdicts of all tests and subtests by name."""
    command = ["go", "test", "-json", "-count=1"]
    done = subprocess.run(command, cwd=package, stdout=subprocess.PIPE, text=True, check=False)
    events = [json.loads(line) for line in done.stdout.splitlines()]
    ends = [event for event in events if "Test" in event and event["Action"] in VERDICTS]
    return {event["Test"]: VERDICTS[event["Action"]] for event in ends}


if __name__ == "__main__":
    sys.exit(main())
