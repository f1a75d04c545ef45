"""Fixtures: set-up, check, collapse, tear-down."""

from __future__ import annotations

from pathlib import Path

import pytest
from driver import Host, plugin

FIXTURE = """
import threading
class Simulator(rtf.FixtureManager):
    def setup(self, args):
        self.report(f"up {args}")
        self.well = True
    def check(self):
        self.well, was = False, self.well
        return was
    def tearDown(self):
        self.report("down")
"""


def test_a_fixture_is_set_up_checked_and_torn_down(tmp_path: Path) -> None:
    host = Host(tmp_path)
    passed = {"outcome": "passed"}
    assert host.ask("set-up-fixture", plugin(tmp_path, FIXTURE))["result"] == passed
    assert host.ask("check-fixture", {})["result"] == passed
    unwell = {"outcome": "failed", "reason": "check returned false"}
    assert host.ask("check-fixture", {})["result"] == unwell
    assert host.ask("tear-down-fixture", {})["result"] == passed
    assert host.texts() == [("report", "up ['--rate', '100']"), ("report", "down")]
    assert host.of("phase") == []
    host.channel.shutdown(1)
    assert host.end()[0] == 0


@pytest.mark.parametrize(
    ("line", "result", "problem"),
    [
        ("return False", {"outcome": "error", "reason": "setup returned false"}, None),
        ("self.require(False, 'license')", {"outcome": "failed"}, ("failure", "license")),
        ("self.error('no license')", {"outcome": "error"}, ("error", "no license")),
        ("raise OSError('no port')", {"outcome": "error"}, ("error", "OSError: no port")),
    ],
)
def test_a_fixture_that_cannot_be_set_up_is_torn_down(
    tmp_path: Path, line: str, result: dict[str, str], problem: tuple[str, str] | None
) -> None:
    host = Host(tmp_path)
    body = (
        f"class Simulator(rtf.FixtureManager):\n    def setup(self, args):\n        {line}\n"
        "    def tearDown(self):\n        self.report('down')\n"
    )
    answer = host.ask("set-up-fixture", plugin(tmp_path, body))
    assert answer["result"] == result
    assert host.problem() == problem
    assert host.ask("tear-down-fixture", {})["result"] == {"outcome": "passed"}
    assert host.texts()[-1] == ("report", "down")


def test_a_thread_reports_a_collapse_between_requests(tmp_path: Path) -> None:
    host = Host(tmp_path)
    body = (
        "import threading\n"
        "class Simulator(rtf.FixtureManager):\n"
        "    def setup(self, args):\n"
        "        lost = threading.Timer(0.05, self.collapsed, ['the bus is silent'])\n"
        "        lost.start()\n"
    )
    assert host.ask("set-up-fixture", plugin(tmp_path, body))["result"] == {"outcome": "passed"}
    assert host.wait_for("collapsed") == {"reason": "the bus is silent"}


def test_a_fixture_without_check_is_healthy(tmp_path: Path) -> None:
    host = Host(tmp_path)
    host.ask("set-up-fixture", plugin(tmp_path, "class Simulator(rtf.FixtureManager): pass\n"))
    assert host.ask("check-fixture", {})["result"] == {"outcome": "passed"}


def test_a_missing_fixture_cannot_be_checked(tmp_path: Path) -> None:
    host = Host(tmp_path)
    answer = host.ask("check-fixture", {})
    assert answer["result"] == {"outcome": "error", "reason": "no fixture is set up"}


def test_a_set_up_can_be_interrupted(tmp_path: Path) -> None:
    host = Host(tmp_path)
    body = (
        "class Simulator(rtf.FixtureManager):\n"
        "    def setup(self, args):\n"
        "        self.report('waiting')\n"
        "        self.wait_until(lambda: False, 1000, 'the port')\n"
    )
    host.send("set-up-fixture", plugin(tmp_path, body), number=2)
    host.wait_for("message")
    host.send("interrupt", {"reason": "Ctrl-C"})
    assert host.answer()["result"] == {"outcome": "interrupted", "reason": "Ctrl-C"}
    assert host.ask("tear-down-fixture", {})["result"] == {"outcome": "passed"}


def test_the_end_of_the_runner_ends_a_fixture_that_is_up(tmp_path: Path) -> None:
    host = Host(tmp_path)
    host.ask("set-up-fixture", plugin(tmp_path, FIXTURE))
    host.channel.shutdown(1)
    assert host.end()[0] == 1
    assert ("report", "down") not in host.texts()


RECORDER = """
class Recorder(rtf.FixtureManager):
    def testStarted(self, test):
        self.report(f"{test.id} {test.name} {test.repetition}.{test.attempt}")
        return test.name != "refused"
    def testFinished(self, test, verdict, reason):
        self.report(f"{test.name} {verdict}: {reason}")
        self.measure("size", 3.5, "MB", high=4.0)
        self.attach(__file__, "run.txt")
"""


def test_a_fixture_is_notified_of_each_test(tmp_path: Path) -> None:
    host = Host(tmp_path)
    answer = host.ask("set-up-fixture", plugin(tmp_path, RECORDER))
    wanted = ["test-started", "test-finished"]
    assert answer["result"] == {"outcome": "passed", "subscriptions": wanted}
    test = {"id": 3, "name": "Move", "repetition": 2, "attempt": 1}
    assert host.ask("test-started", {"test": test})["result"] == {"outcome": "passed"}
    directory = str(tmp_path / "kept")
    ends = {"test": test, "verdict": "failed", "reason": "too far", "attachments_dir": directory}
    assert host.ask("test-finished", ends)["result"] == {"outcome": "passed"}
    assert host.texts() == [("report", "3 Move 2.1"), ("report", "Move failed: too far")]
    assert host.of("measured")[0]["name"] == "size"
    kept = host.of("attached")[0]
    assert kept["path"] == f"{directory}/1-run.txt"
    assert "class Recorder" in Path(kept["path"]).read_text()
    refused = {"test": {**test, "name": "refused"}}
    answer = host.ask("test-started", refused)
    assert answer["result"] == {"outcome": "failed", "reason": "testStarted returned false"}


def test_a_fixture_subscribes_to_what_it_implements(tmp_path: Path) -> None:
    host = Host(tmp_path)
    body = (
        "class Base(rtf.FixtureManager):\n    def testFinished(self, test, verdict, reason):\n"
        "        self.sleep(100)\nclass Simulator(Base): pass\n"
    )
    assert host.ask("set-up-fixture", plugin(tmp_path, FIXTURE))["result"] == {"outcome": "passed"}
    host = Host(tmp_path)
    inherited = {"outcome": "passed", "subscriptions": ["test-finished"]}
    assert host.ask("set-up-fixture", plugin(tmp_path, body))["result"] == inherited
