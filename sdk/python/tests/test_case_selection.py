"""Selected cases, planned cases, and the values of a matrix."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from driver import Host, Ran, arm, plugin, run


def started(ran: Ran) -> list[str]:
    return [params["name"] for params in ran.host.of("case-started")]


SELECTED = arm(
    "with self.case('Arm'):\n"
    "    with self.case('joint 1'): self.report('1')\n"
    "    with self.case('joint 2'):\n        self.report('2')\n"
    "for side in ('left', 'right'):\n"
    "    with self.case(side), self.case('inner'):\n        self.report(side)\n"
    "self.report('end')"
)


@pytest.mark.parametrize(
    ("cases", "names"),
    [
        ([], ["Arm", "joint 1", "joint 2", "left", "inner", "right", "inner"]),
        ([{"equals": "Arm"}], ["Arm", "joint 1", "joint 2"]),
        ([{"equals": "Arm/joint 2"}], ["Arm", "joint 2"]),
        ([{"equals": "Ar"}], []),
        ([{"contains": "ight"}], ["right", "inner"]),
        ([{"contains": "joint"}], []),
        ([{"equals": "left"}, {"contains": "1"}], ["left", "inner"]),
    ],
)
def test_only_selected_cases_run(
    tmp_path: Path, cases: list[dict[str, str]], names: list[str]
) -> None:
    ran = run(tmp_path, SELECTED, cases=cases)
    assert started(ran) == names
    texts = {"joint 1": "1", "joint 2": "2", "left": "left", "right": "right"}
    ends = [texts[name] for name in names if name in texts]
    assert [text for _, text in ran.texts] == [*ends, "end"]
    assert [one["case"] for one in ran.host.of("case-started")] == list(range(1, len(names) + 1))


def test_only_selected_cases_are_planned(tmp_path: Path) -> None:
    body = arm("self.plan_cases(['a', 'b'])\nself.plan_cases(['c'])")
    assert run(tmp_path, body).host.of("cases-planned") == [{"names": ["a", "b"]}, {"names": ["c"]}]
    ran = run(tmp_path, body, cases=[{"equals": "b/inner"}])
    assert ran.host.of("cases-planned") == [{"names": ["b"]}]


def test_many_planned_names_fit_in_the_lines_of_the_protocol(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("self.plan_cases('x' * 200 + str(n) for n in range(100_000))"))
    names = [name for one in ran.host.of("cases-planned") for name in one["names"]]
    assert [name.lstrip("x") for name in names] == [str(number) for number in range(100_000)]
    assert ran.result == {"outcome": "passed"}


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("self.skip('late')", "`skip` is allowed in `setup` and `run` only"),
        ("self.plan_cases(['late'])", "cases are planned in `setup` and `run` only"),
    ],
)
def test_skips_and_plans_in_tear_down_are_errors(tmp_path: Path, line: str, text: str) -> None:
    ran = run(tmp_path, arm("pass", f"    def tearDown(self):\n        {line}\n"))
    assert ran.result == {"outcome": "error"}
    assert ran.texts == [("error", text)]


def test_a_case_that_is_not_selected_leaves_trace_functions_as_they_are(tmp_path: Path) -> None:
    body = arm(
        "import sys\n"
        "lines = []\n"
        "def trace(frame, event, arg):\n"
        "    if event == 'line' and frame.f_code.co_name == 'traced':\n"
        "        lines.append(frame.f_lineno - frame.f_code.co_firstlineno)\n"
        "    return trace\n"
        "def traced():\n"
        "    with self.case('no'):\n"
        "        self.fail('never')\n"
        "    with self.case('yes'):\n"
        "        with self.case('also no'): self.fail('never')\n"
        "        done = True\n"
        "    return done\n"
        "sys.settrace(trace)\n"
        "traced()\n"
        "kept = sys.gettrace() is trace\n"
        "sys.settrace(None)\n"
        "self.check(kept, 'the tracer is kept')\n"
        "self.report(sorted(set(lines)))\n"
        "with self.case('no'): self.fail('never')\n"
        "self.check(sys.gettrace() is None, 'no tracer')\n"
        "self.check(sys._getframe().f_trace is None, 'no local tracer')"
    )
    ran = run(tmp_path, body, cases=[{"equals": "yes/also yes"}])
    assert ran.texts == [
        ("check", "the tracer is kept"),
        ("report", "[1, 3, 4, 5, 6]"),
        ("check", "no tracer"),
        ("check", "no local tracer"),
    ]


def test_an_exit_stack_skips_a_case_that_is_not_selected(tmp_path: Path) -> None:
    body = arm(
        "import contextlib\n"
        "for name in ('a', 'b'):\n"
        "    with contextlib.ExitStack() as stack:\n"
        "        stack.enter_context(self.case(name))\n"
        "        self.report(name)\n"
        "self.report('end')"
    )
    ran = run(tmp_path, body, cases=[{"equals": "b"}])
    assert ran.texts == [("report", "b"), ("report", "end")]


def test_a_test_has_the_values_of_its_matrix(tmp_path: Path) -> None:
    values = [{"name": "joint", "value": "0"}, {"name": "side", "value": "left"}]
    body = arm(
        "self.report(self.parameter('side'))\nself.report(self.parameters)\n"
        "self.parameter('speed')\nself.report('never')"
    )
    ran = run(tmp_path, body, parameters=values)
    assert ran.texts == [
        ("report", "left"),
        ("report", "{'joint': '0', 'side': 'left'}"),
        ("error", 'there is no parameter "speed"; this test has joint, side'),
    ]
    assert run(tmp_path, arm("self.parameter('speed')")).texts == [
        ("error", 'there is no parameter "speed"; this test has none')
    ]


@pytest.mark.parametrize("wrong", [{"cases": [{"matches": "a"}]}, {"parameters": {"joint": "0"}}])
def test_wrong_parameters_of_a_request_are_refused(tmp_path: Path, wrong: dict[str, Any]) -> None:
    host = Host(tmp_path)
    answer = host.ask("run-test", {**plugin(tmp_path, arm("pass")), **wrong})
    assert answer["error"]["code"] == -32602
