"""Builds one project against robot-testing-framework 2.x and against rtf, and compares verdicts.

compare.py PREDECESSOR PREFIX WORK: the unpacked packages, an installed rtf, and a directory to
work in. Prints every case with its reason, and fails if one differs from the tables.
"""

from __future__ import annotations

import difflib
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from embedded import DIFFERENT, SAME
from expected import SUITES, TESTS, Row
from sides import Side, build

HERE = Path(__file__).resolve().parent


class Report:
    """Counts the cases and prints differences."""

    def __init__(self) -> None:
        """No case has been checked yet."""
        self.cases = 0
        self.wrong = 0

    def expect(self, what: str, got: object, expected: object, why: str = "") -> None:
        """One comparison."""
        self.cases += 1
        mark = "equal" if not why else "ours "
        if got == expected:
            print(f"ok     {mark} {what}" + (f"\n               {why}" if why else ""))
        else:
            self.wrong += 1
            print(f"WRONG  {what}\n  expected {expected}\n  got      {got}")


def compare_rows(report: Report, old: Side, new: Side, rows: list[Row], kind: str) -> None:
    """Compares the plug-ins in both runners."""
    for row in rows:
        if row.old != row.new and not row.why:
            raise ValueError(f"a difference without a reason: {row.what}")
        expected = (row.old, row.new)
        call = Side.test if kind == "test" else Side.suite
        got = (None if row.old is None else call(old, row.what), call(new, row.what))
        report.expect(f"{kind} {row.what}", got, expected, row.why)


def compare_embedded(report: Report, old: Side, new: Side) -> None:
    """Compares a program that uses the classes of both libraries."""
    scenarios = dict.fromkeys(SAME, ("", "")) | DIFFERENT
    for scenario, (why, expected) in scenarios.items():
        lines = difflib.unified_diff(
            old.embedded(scenario), new.embedded(scenario), n=0, lineterm=""
        )
        changes = [line for line in list(lines)[2:] if not line.startswith("@@")]
        report.expect(f"program {scenario}", changes, expected.strip("\n").splitlines(), why)


def load(side: Side, fixture: Path, test: Path) -> tuple[int, str, str, list[str]]:
    """A program that loads a fixture and a test: exit code, output, result.txt and log."""
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        ran = subprocess.run(
            [str(side.build / "legacy_loader"), str(fixture), str(test), "check"],
            cwd=directory,
            env=side.environment(directory / "log"),
            capture_output=True,
            text=True,
            check=False,
        )
        result = directory / "loaded.txt"
        text = result.read_text() if result.exists() else ""
        log = directory / "log"
        return ran.returncode, ran.stdout, text, log.read_text().split("\n") if log.exists() else []


def compare_loaders(report: Report, old: Side, new: Side) -> None:
    """Each loads its own plug-ins in the same way, and rejects the other's."""
    theirs = load(old, old.build / "plugins/Rig.so", old.build / "plugins/Endings.so")
    ours = load(new, new.build / "plugins/Rig.so", new.build / "plugins/Endings.so")
    report.expect("loaders: exit code", ours[0], theirs[0])
    report.expect("loaders: result.txt", ours[2], theirs[2])
    report.expect("loaders: order of calls", ours[3], theirs[3])
    code, said, _, _ = load(new, new.build / "plugins/Rig.so", new.build / "nowhere.so")
    report.expect("loaders: a missing plug-in", (code, "nowhere.so" in said), (4, True))
    code, _, _, log = load(old, old.build / "plugins/Rig.so", new.build / "plugins/Endings.so")
    report.expect("the predecessor rejects our plug-in", (code, log), (4, []))
    code, _, _, log = load(new, old.build / "plugins/Rig.so", new.build / "plugins/Endings.so")
    report.expect("rtf rejects the predecessor's plug-in", (code, log), (3, []))
    ran = subprocess.run(
        [str(new.prefix / "bin/rtf"), "check", str(old.build / "plugins/Endings.so")],
        env=os.environ | {"LD_LIBRARY_PATH": old.environment(Path())["LD_LIBRARY_PATH"]},
        capture_output=True,
        text=True,
        check=False,
    )
    words = "was built for robot-testing-framework 2: build it again" in ran.stderr
    report.expect("rtf suggests a rebuild", (ran.returncode, words), (2, True))


def ctest(side: Side) -> tuple[list[str], list[bool]]:
    """CTest's results of the suites, and whether the result files were written."""
    ran = subprocess.run(
        ["ctest"],
        cwd=side.build,
        env=side.environment(side.build / "log"),
        capture_output=True,
        text=True,
        check=False,
    )
    lines = [line for line in ran.stdout.splitlines() if re.search(r" Test +#[0-9]+: ", line)]
    words = [line.replace("*", " ").replace(".", " ").split() for line in lines]
    results = [(side.build / name).exists() for name in ("good.txt", "bad.txt")]
    return [f"{name} {verdict}" for _, _, _, name, verdict, *_ in words], results


def main() -> int:
    """Returns the exit code."""
    predecessor, prefix, work = (Path(argument).resolve() for argument in sys.argv[1:4])
    old = Side(predecessor / "usr", work / "old", is_ours=False)
    new = Side(prefix, work / "new", is_ours=True)
    for side in (old, new):
        build(HERE / "project", side.build, f"-DCMAKE_PREFIX_PATH={side.prefix}")
    report = Report()
    compare_rows(report, old, new, TESTS, "test")
    compare_rows(report, old, new, SUITES, "suite")
    compare_embedded(report, old, new)
    compare_loaders(report, old, new)
    report.expect("ctest", ctest(old), (["good Passed", "bad Failed"], [True, True]))
    report.expect("ctest", ctest(new), (["good Passed", "bad Failed"], [True, True]))
    print(f"{report.cases} cases, {report.wrong} wrong")
    return 1 if report.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
