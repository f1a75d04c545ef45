"""Values that fixtures provide, and that tests, hooks and fixtures read."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from driver import Host, arm, plugin, run

KNOWN = [
    {"name": "simulator.port", "value": 40123},
    {"name": "simulator.model", "value": "arm"},
    {"name": "simulator.limits", "value": [-1.5, 1.5]},
]


def fixture(setup: str, more: str = "") -> str:
    """Return the source of a fixture whose `setup` has these lines."""
    lines = "".join(f"        {line}\n" for line in setup.splitlines())
    return f"class Simulator(rtf.FixtureManager):\n    def setup(self, args):\n{lines}{more}"


def set_up(directory: Path, setup: str) -> tuple[Host, dict[str, Any]]:
    host = Host(directory)
    answer = host.ask("set-up-fixture", plugin(directory, fixture(setup)))
    return host, answer["result"]


def test_a_fixture_provides_values(tmp_path: Path) -> None:
    host, result = set_up(
        tmp_path,
        "self.provide('port', 40123)\n"
        "self.provide('model', 'Bär \"1\"')\n"
        "self.provide('ready', True)\n"
        "self.provide('limits', (-1.5, 1.5))\n"
        "self.provide('joints', {'elbow': [0, None]})\n"
        "self.report('up')",
    )
    assert result == {"outcome": "passed"}
    assert host.of("provided") == [
        {"name": "port", "value": 40123},
        {"name": "model", "value": 'Bär "1"'},
        {"name": "ready", "value": True},
        {"name": "limits", "value": [-1.5, 1.5]},
        {"name": "joints", "value": {"elbow": [0, None]}},
    ]
    assert host.texts() == [("report", "up")]


@pytest.mark.parametrize(
    ("value", "problem"),
    [
        ("None", "the value of `port` is None"),
        ("{1, 2}", "the value of `port` is not JSON: Object of type set is not "),
        ("[float('nan')]", "the value of `port` is not JSON: Out of range float values "),
        ("float('inf')", "the value of `port` is not JSON: Out of range float values "),
        ("[(r := []), r.append(r)]", "the value of `port` is not JSON: Circular reference "),
    ],
)
def test_a_value_that_is_not_json_is_an_error(tmp_path: Path, value: str, problem: str) -> None:
    host, result = set_up(tmp_path, f"self.provide('port', {value})\nself.report('never')")
    assert result == {"outcome": "error"}
    assert host.of("provided") == []
    [message] = host.of("message")
    assert message["kind"] == "error"
    assert message["text"].startswith(f"TypeError: {problem}")
    assert message["location"] == {"file": str(tmp_path / "plugin.py"), "line": 4}


def test_a_forked_child_provides_no_values(tmp_path: Path) -> None:
    host, result = set_up(
        tmp_path,
        "import os\n"
        "child = os.fork()\n"
        "if not child:\n"
        "    self.provide('port', 1)\n"
        "    self.report('in the child')\n"
        "    os._exit(0)\n"
        "os.waitpid(child, 0)\n"
        "self.provide('port', 2)",
    )
    assert result == {"outcome": "passed"}
    assert host.texts() == [("report", "in the child")]
    assert host.of("provided") == [{"name": "port", "value": 2}]


def test_a_test_reads_values_in_each_step(tmp_path: Path) -> None:
    body = (
        "class Arm(rtf.TestCase):\n"
        "    def setup(self, args):\n"
        "        self.report(self.fixture_value('simulator.port') + 1)\n"
        "    def run(self):\n"
        "        self.report(self.fixture_value('simulator.model'))\n"
        "    def tearDown(self):\n"
        "        self.report(self.fixture_value('simulator.limits')[0])\n"
    )
    ran = run(tmp_path, body, fixture_values=KNOWN)
    assert ran.result == {"outcome": "passed"}
    assert ran.texts == [("report", "40124"), ("report", "arm"), ("report", "-1.5")]


def test_an_unknown_value_is_an_error_that_lists_the_known_ones(tmp_path: Path) -> None:
    body = arm("self.fixture_value('simulator.speed')\nself.report('never')")
    ran = run(tmp_path, body, fixture_values=KNOWN)
    assert ran.result == {"outcome": "error"}
    known = "simulator.port, simulator.model, simulator.limits"
    assert ran.texts == [
        ("error", f'there is no fixture value "simulator.speed"; there are {known}')
    ]
    assert ran.host.of("message")[0]["location"]["line"] == 4
    assert run(tmp_path, body).texts == [
        ("error", 'there is no fixture value "simulator.speed"; there are none')
    ]


def test_a_fixture_reads_the_values_of_others_in_each_step(tmp_path: Path) -> None:
    step = "        self.report(self.fixture_value('simulator.port'))\n"
    more = f"    def check(self):\n{step}    def tearDown(self):\n{step}"
    body = fixture("self.report(self.fixture_value('simulator.port'))", more)
    host = Host(tmp_path)
    host.ask("set-up-fixture", {**plugin(tmp_path, body), "fixture_values": KNOWN})
    host.ask("check-fixture", {})
    host.ask("tear-down-fixture", {})
    assert host.texts() == [("report", "40123")] * 3


@pytest.mark.parametrize(
    "wrong",
    [{"port": 1}, ["port"], [{"value": 1}], [{"name": "a.b"}], [{"name": "a.b", "value": None}]],
)
def test_wrong_values_in_a_request_are_refused(tmp_path: Path, wrong: object) -> None:
    host = Host(tmp_path)
    answer = host.ask("run-test", {**plugin(tmp_path, arm("pass")), "fixture_values": wrong})
    assert answer["error"]["code"] == -32602
