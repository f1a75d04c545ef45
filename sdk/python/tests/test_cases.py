"""Cases inside a test, and skips."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from driver import Host, Ran, arm, plugin, run

TEAR_DOWN = "    def tearDown(self):\n        self.report('torn down')\n"


def events(ran: Ran) -> list[tuple[Any, ...]]:
    """Return the starts and ends of cases, and the messages with their cases."""
    found: list[tuple[Any, ...]] = []
    for message in ran.host.seen:
        method, params = message.get("method"), message.get("params", {})
        if method == "case-started":
            found.append(("start", params["case"], params["name"], params.get("parent")))
        elif method == "case-finished":
            found.append(("end", params["case"], params.get("outcome")))
        elif method == "message":
            text = params["text"].partition("\n")[0]
            found.append((params["kind"], text, params.get("case")))
    return found


def test_a_case_has_a_number_parameters_and_a_location(tmp_path: Path) -> None:
    ran = run(
        tmp_path,
        arm(
            "with self.case('joint 3', joint=3, name='left', on=True, to=0.5):\n"
            "    self.report('moved')\n"
            "self.report('after')"
        ),
    )
    assert ran.result == {"outcome": "passed"}
    (start,) = ran.host.of("case-started")
    values = {"joint": "3", "name": "left", "on": "true", "to": "0.5"}
    assert start == {
        "case": 1,
        "name": "joint 3",
        "parameters": [{"name": name, "value": value} for name, value in values.items()],
        "location": {"file": str(tmp_path / "plugin.py"), "line": 4},
    }
    assert events(ran) == [
        ("start", 1, "joint 3", None),
        ("report", "moved", 1),
        ("end", 1, None),
        ("report", "after", None),
    ]


@pytest.mark.parametrize(
    ("body", "kind", "text"),
    [
        ("self.require(False, 'it moves')", "failure", "it moves"),
        ("self.require_near(1, 2, 0.1, 'x')", "failure", "x: got 1, expected 2 ± 0.1 (off by 1)"),
        ("self.wait_until(lambda: 0, 0, 'x')", "failure", "x: not within 0 s (last value: 0)"),
        ("self.error('no bench')", "error", "no bench"),
        ("raise ValueError('42')", "error", "ValueError: 42"),
        ("raise rtf.Error('no arm')", "error", "no arm"),
        ("raise KeyboardInterrupt", "error", "KeyboardInterrupt"),
    ],
)  # fmt: skip
def test_a_problem_ends_the_case_and_the_test_continues(
    tmp_path: Path, body: str, kind: str, text: str
) -> None:
    ran = run(
        tmp_path,
        arm(
            f"with self.case('one'):\n    {body}\n    self.report('never')\n"
            "with self.case('two'):\n    self.report('on')",
            TEAR_DOWN,
        ),
    )
    assert events(ran) == [
        ("start", 1, "one", None),
        (kind, text, 1),
        ("end", 1, None),
        ("start", 2, "two", None),
        ("report", "on", 2),
        ("end", 2, None),
        ("report", "torn down", None),
    ]
    assert ran.result == {"outcome": "failed" if kind == "failure" else "error"}


def test_the_traceback_of_an_exception_in_a_case_begins_in_the_plugin(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("with self.case('one'):\n    raise ValueError('42')"))
    (message,) = ran.host.of("message")
    assert message["location"] == {"file": str(tmp_path / "plugin.py"), "line": 5}
    assert "_cases.py" not in message["text"]
    assert "raise ValueError('42')" in message["text"]


def test_cases_nest(tmp_path: Path) -> None:
    ran = run(
        tmp_path,
        arm(
            "with self.case('Arm'):\n"
            "    with self.case('Moves'):\n        self.require(False, 'it moves')\n"
            "    with self.case('Stops'):\n        pass\n"
            "    self.report('still here')\n"
            "with self.case('Hand'):\n    pass"
        ),
    )
    assert events(ran) == [
        ("start", 1, "Arm", None),
        ("start", 2, "Moves", 1),
        ("failure", "it moves", 2),
        ("end", 2, None),
        ("start", 3, "Stops", 1),
        ("end", 3, None),
        ("report", "still here", 1),
        ("end", 1, None),
        ("start", 4, "Hand", None),
        ("end", 4, None),
    ]


def test_a_critical_assertion_finishes_its_cases_and_ends_the_test(tmp_path: Path) -> None:
    ran = run(
        tmp_path,
        arm(
            "with self.case('arm'):\n    with self.case('dangerous'):\n"
            "        self.require_critical(False, 'the arm is free')\n"
            "with self.case('never'):\n    pass",
            TEAR_DOWN,
        ),
    )
    assert events(ran) == [
        ("start", 1, "arm", None),
        ("start", 2, "dangerous", 1),
        ("failure", "the arm is free", 2),
        ("end", 2, None),
        ("end", 1, None),
        ("report", "torn down", None),
    ]


def test_a_case_skips_itself(tmp_path: Path) -> None:
    ran = run(
        tmp_path,
        arm(
            "with self.case('gripper'):\n    self.skip('no gripper is mounted')\n"
            "with self.case('arm'):\n    pass"
        ),
    )
    assert ran.host.of("case-finished") == [
        {"case": 1, "outcome": "skipped", "reason": "no gripper is mounted"},
        {"case": 2},
    ]
    assert ran.result == {"outcome": "passed"}


def test_a_test_skips_itself_in_run(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("self.skip('no camera')\nself.report('after')", TEAR_DOWN))
    assert ran.result == {"outcome": "skipped", "reason": "no camera"}
    assert ran.texts == [("report", "torn down")]
    assert ran.code == 0


def test_a_test_skips_itself_in_setup(tmp_path: Path) -> None:
    setup = "    def setup(self, args):\n        self.skip('no robot')\n"
    ran = run(tmp_path, arm("self.report('never')", setup + TEAR_DOWN))
    assert ran.result == {"outcome": "skipped", "reason": "no robot"}
    assert ran.phases == ["setup", "tear-down"]


@pytest.mark.parametrize(
    ("before", "tear_down"),
    [("self.check(False, 'power')", "pass"), ("pass", "self.check(False, 'power')")],
)
def test_a_failure_has_precedence_over_a_skip(tmp_path: Path, before: str, tear_down: str) -> None:
    more = f"    def tearDown(self):\n        {tear_down}\n"
    ran = run(tmp_path, arm(f"{before}\nself.skip('no camera')", more))
    assert ran.result == {"outcome": "failed"}


@pytest.mark.parametrize("step", ["setup", "tearDown"])
def test_a_case_outside_of_run_is_an_error_and_its_body_does_not_run(
    tmp_path: Path, step: str
) -> None:
    parameters = "self, args" if step == "setup" else "self"
    more = (
        f"    def {step}({parameters}):\n"
        "        with self.case('early'): self.report('never')\n"
        "        self.report('after')\n"
    )
    ran = run(tmp_path, arm("pass", more))
    assert ran.texts == [("error", "cases are allowed in `run` only"), ("report", "after")]
    assert ran.host.of("case-started") == []
    assert ran.result == {"outcome": "error"}


def test_messages_of_other_threads_belong_to_their_own_case_or_that_of_the_test(
    tmp_path: Path,
) -> None:
    body = (
        "import threading\n"
        "def call(function):\n"
        "    thread = threading.Thread(target=function)\n"
        "    thread.start()\n"
        "    thread.join()\n"
        "def own():\n"
        "    with self.case('thread'):\n        self.report('in a case')\n"
        "    self.report('without a case')\n"
        "with self.case('main'):\n    call(own)\n"
        "call(lambda: self.report('after'))"
    )
    assert events(run(tmp_path, arm(body))) == [
        ("start", 1, "main", None),
        ("start", 2, "thread", None),
        ("report", "in a case", 2),
        ("end", 2, None),
        ("report", "without a case", 1),
        ("end", 1, None),
        ("report", "after", None),
    ]


def test_many_threads_number_their_cases_in_the_order_of_the_channel(tmp_path: Path) -> None:
    body = (
        "import threading\n"
        "def work(index):\n"
        "    for turn in range(50):\n"
        "        with self.case(f'{index}.{turn}'):\n            self.report(f'{index}.{turn}')\n"
        "threads = [threading.Thread(target=work, args=(i,)) for i in range(8)]\n"
        "for thread in threads: thread.start()\n"
        "for thread in threads: thread.join()"
    )
    ran = run(tmp_path, arm(body))
    starts = ran.host.of("case-started")
    assert [start["case"] for start in starts] == list(range(1, 401))
    names = {start["case"]: start["name"] for start in starts}
    assert all(names[one["case"]] == one["text"] for one in ran.host.of("message"))
    assert sorted(one["case"] for one in ran.host.of("case-finished")) == list(range(1, 401))


def test_concurrent_tasks_have_separate_cases(tmp_path: Path) -> None:
    body = (
        "import asyncio\n"
        "async def a(reported, ended):\n"
        "    with self.case('a'):\n"
        "        await reported.wait()\n        self.report('a')\n"
        "    ended.set()\n"
        "async def b(reported, ended):\n"
        "    with self.case('b'):\n"
        "        self.report('b')\n        reported.set()\n"
        "        await ended.wait()\n"
        "async def both():\n"
        "    reported, ended = asyncio.Event(), asyncio.Event()\n"
        "    await asyncio.gather(a(reported, ended), b(reported, ended))\n"
        "asyncio.run(both())"
    )
    assert events(run(tmp_path, arm(body))) == [
        ("start", 1, "a", None),
        ("start", 2, "b", None),
        ("report", "b", 2),
        ("report", "a", 1),
        ("end", 1, None),
        ("end", 2, None),
    ]


def test_samples_measurements_and_attachments_belong_to_the_case(tmp_path: Path) -> None:
    (tmp_path / "trace.csv").write_text("1\n", encoding="utf-8")
    body = (
        "self.sample('x', 0.0)\n"
        "with self.case('one'):\n"
        "    self.sample('x', 1.0)\n    self.measure('rate', 2.0)\n"
        "    self.attach('trace.csv')\n    self.sample('x', 3.0)\n"
        "self.sample('x', 4.0)"
    )
    ran = run(tmp_path, arm(body))
    batches = ran.host.of("sampled")
    assert [(one.get("case"), [value for _, value in one["points"]]) for one in batches] == [
        (None, [0.0]),
        (1, [1.0]),
        (1, [3.0]),
        (None, [4.0]),
    ]
    assert [one["case"] for one in ran.host.of("measured") + ran.host.of("attached")] == [1, 1]
    order = [one["method"] for one in ran.host.seen if one.get("method", "phase") != "phase"]
    assert order == [
        "sampled",
        "case-started",
        "sampled",
        "measured",
        "attached",
        "sampled",
        "case-finished",
        "sampled",
    ]


def test_a_forked_child_sends_no_cases(tmp_path: Path) -> None:
    body = (
        "import os\n"
        "with self.case('parent'):\n"
        "    child = os.fork()\n"
        "    if not child:\n"
        "        with self.case('inner'):\n"
        "            self.report('in the child')\n            self.require(False, 'it moves')\n"
        "        self.report('after the case')\n"
        "        os._exit(0)\n"
        "    os.waitpid(child, 0)"
    )
    assert events(run(tmp_path, arm(body))) == [
        ("start", 1, "parent", None),
        ("report", "in the child", 1),
        ("failure", "it moves", 1),
        ("report", "after the case", 1),
        ("end", 1, None),
    ]


@pytest.mark.parametrize(
    "waiting", ["self.sleep(1000)", "import time; time.sleep(1000)", "while True: pass"]
)
def test_a_stop_request_ends_the_test_and_leaves_the_case_open(
    tmp_path: Path, waiting: str
) -> None:
    host = Host(tmp_path)
    body = arm(
        f"with self.case('one'):\n    self.report('going')\n    {waiting}\n"
        "with self.case('two'):\n    pass",
        TEAR_DOWN,
    )
    host.send("run-test", plugin(tmp_path, body), number=2)
    host.wait_for("message")
    host.send("interrupt", {"reason": "Ctrl-C"})
    assert host.answer()["result"] == {"outcome": "interrupted", "reason": "Ctrl-C"}
    assert len(host.of("case-started")) == 1
    assert host.of("case-finished") == []
    assert host.texts() == [("report", "going"), ("report", "torn down")]
    assert "case" not in host.of("message")[1]


def test_the_end_of_the_process_leaves_the_case_open(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("with self.case('one'):\n    raise SystemExit(0)"))
    assert ran.result is None
    assert events(ran) == [("start", 1, "one", None)]


def test_a_case_whose_thread_ends_finishes(tmp_path: Path) -> None:
    body = (
        "import sys, threading\n"
        "def leave():\n"
        "    with self.case('thread'):\n        sys.exit()\n"
        "thread = threading.Thread(target=leave)\n"
        "thread.start()\n"
        "thread.join()\n"
        "with self.case('main'):\n    pass"
    )
    ran = run(tmp_path, arm(body))
    assert [one["case"] for one in ran.host.of("case-finished")] == [1, 2]
    # As without the case.
    assert ran.problem == ("error", "SystemExit")


def test_a_case_of_a_generator_that_is_closed_finishes(tmp_path: Path) -> None:
    body = (
        "def poses():\n"
        "    with self.case('pose'):\n        yield 1\n"
        "generator = poses()\n"
        "next(generator)\n"
        "generator.close()\n"
        "self.report('after')"
    )
    assert events(run(tmp_path, arm(body))) == [
        ("start", 1, "pose", None),
        ("end", 1, None),
        ("report", "after", None),
    ]


def test_a_stopped_test_starts_no_further_case(tmp_path: Path) -> None:
    host = Host(tmp_path)
    body = arm(
        "with self.case('one'):\n    self.report('going')\n"
        "    while not self.interrupted(): pass\n"
        "with self.case('two'): self.report('never')\n"
        "self.report('after')"
    )
    host.send("run-test", plugin(tmp_path, body), number=2)
    host.wait_for("message")
    host.send("interrupt", {"reason": "Ctrl-C"})
    assert host.answer()["result"] == {"outcome": "interrupted", "reason": "Ctrl-C"}
    assert host.texts() == [("report", "going"), ("report", "after")]
    assert (len(host.of("case-started")), host.of("case-finished")) == (1, [])
