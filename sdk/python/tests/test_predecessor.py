"""Tests that were written for robot-testing-framework 2.x."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from driver import Ran, run
from test_loading import _command


def old(folder: Path, body: str, **more: Any) -> Ran:
    """Run a file that is not the present interface's."""
    file = folder / "old.py"
    file.write_text(body, encoding="utf-8")
    return run(folder, "", **{"file": str(file), "param": '--rate "1 2"', **more})


def test_the_class_is_found_and_called_as_it_was(tmp_path: Path) -> None:
    ran = old(
        tmp_path,
        "class TestCase:\n"
        "    def setup(self, param):\n"
        "        robottestingframework.setName('MyTest')\n"
        "        robottestingframework.testReport(param)\n"
        "        return True\n"
        "    def run(self):\n"
        "        robottestingframework.testCheck(5 > 3, 'more')\n"
        "        robottestingframework.testFailIf([], 'nothing')\n"
        "    def tearDown(self):\n"
        "        robottestingframework.testReport('down')\n",
    )
    assert ran.texts == [
        ("report", "test name: MyTest"),
        ("report", '--rate "1 2"'),
        ("check", "more"),
        ("failure", "nothing"),
        ("report", "down"),
    ]
    assert ran.result == {"outcome": "failed"}
    places = [message["location"] for message in ran.host.of("message")]
    assert [Path(place["file"]).name for place in places] == ["old.py"] * 5
    assert [place["line"] for place in places] == [3, 4, 7, 8, 10]


@pytest.mark.parametrize("name", ["robottestingframework", "RTF"])
def test_only_run_is_needed_and_the_module_may_be_imported(tmp_path: Path, name: str) -> None:
    (tmp_path / "arms.py").write_text(
        "import robottestingframework\n"
        "def calibrate(): robottestingframework.assertError('no bus')\n"
    )
    body = (
        f"import arms\nclass TestCase(object):\n    def run(self):\n"
        f"        {name}.testReport('going')\n        arms.calibrate()\n"
    )
    ran = old(tmp_path, body)
    assert ran.texts == [("report", "going"), ("error", "no bus")]
    assert ran.result == {"outcome": "error"}
    assert ran.host.of("message")[1]["location"]["file"].endswith("arms.py")


@pytest.mark.parametrize(
    ("returned", "result"),
    [
        ("1", {"outcome": "passed"}),
        ("False", {"outcome": "error", "reason": "setup returned false"}),
        ("0", {"outcome": "error", "reason": "setup returned false"}),
    ],
)
def test_setup_has_to_return_something_true(
    tmp_path: Path, returned: str, result: dict[str, str]
) -> None:
    body = (
        f"class TestCase:\n    def setup(self, param): return {returned}\n    def run(self): pass\n"
    )
    assert old(tmp_path, body).result == result


def test_a_setup_that_returns_nothing_is_an_error(tmp_path: Path) -> None:
    ran = old(tmp_path, "class TestCase:\n    def setup(self, p): pass\n    def run(self): pass\n")
    assert ran.result == {"outcome": "error"}
    assert ran.texts == [("error", "setup returned nothing, it has to return true")]


def test_a_coroutine_that_nobody_runs_is_no_success(tmp_path: Path) -> None:
    ran = old(tmp_path, "class TestCase:\n    async def run(self): pass\n")
    assert ran.result is not None
    assert ran.result["outcome"] == "error"


def test_only_a_class_of_the_file_named_test_case_is_a_test(tmp_path: Path) -> None:
    for body in ("class Arm:\n    def run(self): pass\n", "from unittest import TestCase\n"):
        ran = old(tmp_path, body)
        assert "has no class that derives from rtf.TestCase" in ran.texts[0][1]


def test_a_test_case_that_derives_from_the_sdk_is_no_test_of_the_predecessor(
    tmp_path: Path,
) -> None:
    body = "class TestCase(rtf.TestCase):\n    def run(self): self.report(self.param)\n"
    ran = old(tmp_path, "import rtf\n" + body)
    assert ran.texts == [("report", '--rate "1 2"')]


def test_the_check_knows_it_as_a_test(tmp_path: Path) -> None:
    (tmp_path / "old.py").write_text("class TestCase:\n    def run(self): pass\n")
    checked = _command("--check", "old.py", folder=tmp_path)
    assert json.loads(checked.stdout) == {"file": "old.py", "ok": True, "kinds": ["test"]}
