"""Verdicts of one project that is built against robot-testing-framework 2.x and against rtf."""

from __future__ import annotations

import difflib
import os
import re
import subprocess
import tempfile
from pathlib import Path

import pytest
from embedded_outputs import DIFFERENT, SAME
from expected_outcomes import SUITES, TESTS, Row
from predecessor_sides import Side, build

HERE = Path(__file__).resolve().parent
SCENARIOS = dict.fromkeys(SAME, ("", "")) | DIFFERENT
Sides = tuple[Side, Side]


@pytest.fixture(scope="module")
def sides(predecessor: Path, prefix: Path, work: Path) -> Sides:
    """2.x and ours, with the project."""
    old = Side(predecessor, work / "old", is_ours=False)
    new = Side(prefix, work / "new", is_ours=True)
    for side in (old, new):
        build(HERE / "project", side.build, f"-DCMAKE_PREFIX_PATH={side.prefix}")
    return old, new


def name_of(row: Row) -> str:
    """The name of a case: without quotes, so that shells accept it."""
    return re.sub(r"[<>'\"]+", " ", row.what).strip()


@pytest.mark.parametrize("row", TESTS, ids=name_of)
def test_verdict_of_a_test(sides: Sides, row: Row) -> None:
    old, new = sides
    assert row.old == row.new or row.why, "a difference without a reason"
    assert row.old is None or old.test(row.what) == row.old
    assert new.test(row.what) == row.new


@pytest.mark.parametrize("row", SUITES, ids=name_of)
def test_verdicts_of_a_suite(sides: Sides, row: Row) -> None:
    old, new = sides
    assert row.old == row.new or row.why, "a difference without a reason"
    assert row.old is None or old.suite(row.what) == row.old
    assert new.suite(row.what) == row.new


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_program_with_the_classes_of_both_libraries(sides: Sides, scenario: str) -> None:
    old, new = sides
    outputs = (old.embedded(scenario), new.embedded(scenario))
    lines = list(difflib.unified_diff(*outputs, n=0, lineterm=""))[2:]
    _, expected = SCENARIOS[scenario]
    found = [line for line in lines if not line.startswith("@@")]
    assert found == expected.strip("\n").splitlines()


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


def test_loaders_behave_the_same(sides: Sides) -> None:
    old, new = sides
    theirs = load(old, old.build / "plugins/Rig.so", old.build / "plugins/Endings.so")
    ours = load(new, new.build / "plugins/Rig.so", new.build / "plugins/Endings.so")
    assert ours[0] == theirs[0]
    assert ours[2:] == theirs[2:], "result.txt and the order of calls"


def test_missing_plugin(sides: Sides) -> None:
    _, new = sides
    code, said, _, _ = load(new, new.build / "plugins/Rig.so", new.build / "nowhere.so")
    assert code == 4
    assert "nowhere.so" in said


def test_each_rejects_the_plugins_of_the_other(sides: Sides) -> None:
    old, new = sides
    code, _, _, log = load(old, old.build / "plugins/Rig.so", new.build / "plugins/Endings.so")
    assert (code, log) == (4, [])
    code, _, _, log = load(new, old.build / "plugins/Rig.so", new.build / "plugins/Endings.so")
    assert (code, log) == (3, [])


def test_rtf_suggests_a_rebuild(sides: Sides) -> None:
    old, new = sides
    ran = subprocess.run(
        [str(new.prefix / "bin/rtf"), "check", str(old.build / "plugins/Endings.so")],
        env=os.environ | {"LD_LIBRARY_PATH": old.environment(Path())["LD_LIBRARY_PATH"]},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 2
    assert "was built for robot-testing-framework 2: build it again" in ran.stderr


def test_suites_in_ctest(sides: Sides) -> None:
    for side in sides:
        assert ctest(side) == (["good Passed", "bad Failed"], [True, True])


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
