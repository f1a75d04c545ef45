"""The outcome of a test."""

from __future__ import annotations

from pathlib import Path

import pytest
from driver import arm, run

TEAR_DOWN = "    def tearDown(self):\n        self.report('torn down')\n"


def test_a_pass_goes_through_all_steps_and_ends_with_exit_code_0(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("self.report('hello')\nself.check(1 == 1, 'one')", TEAR_DOWN))
    assert ran.result == {"outcome": "passed"}
    assert ran.texts == [("report", "hello"), ("check", "one"), ("report", "torn down")]
    assert ran.phases == ["setup", "run", "tear-down"]
    assert ran.code == 0


@pytest.mark.parametrize(
    ("body", "kind", "text", "continues"),
    [
        ("self.check(False, 'closed')", "failure", "closed", True),
        ("self.check(None, 'closed')", "failure", "closed", True),
        ("self.require(0, 'calibrated')", "failure", "calibrated", False),
        ("self.fail('50% too fast')", "failure", "50% too fast", False),
        ("self.error('no encoder')", "error", "no encoder", False),
        ("raise ValueError('42')", "error", "ValueError: 42", False),
        ("raise KeyboardInterrupt", "error", "KeyboardInterrupt", False),
        ("import nowhere", "error", "ModuleNotFoundError: No module named 'nowhere'", False),
    ],
)  # fmt: skip
def test_a_problem_is_reported_and_the_test_torn_down(
    tmp_path: Path, body: str, kind: str, text: str, *, continues: bool
) -> None:
    ran = run(tmp_path, arm(f"{body}\nself.report('on')\nself.fail('later')", TEAR_DOWN))
    assert ran.result is not None
    assert ran.result["outcome"] in {"failed", "error"}
    assert ran.problem == (kind, text)
    assert (("report", "on") in ran.texts) == continues
    assert ran.texts[-1] == ("report", "torn down")
    assert ran.code == 0


def test_an_exception_is_reported_with_its_traceback_and_location(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("raise ValueError('42')"))
    (message,) = ran.host.of("message")
    assert message["kind"] == "error"
    assert message["location"] == {"file": str(tmp_path / "plugin.py"), "line": 4}
    assert message["text"].startswith("ValueError: 42\nTraceback (most recent call last):\n")
    assert "raise ValueError('42')" in message["text"]
    assert "steps.py" not in message["text"]


def test_a_raised_error_is_reported_by_its_text_alone(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("class Absent(rtf.Error): pass\nraise Absent('no arm')"))
    assert ran.result == {"outcome": "error"}
    (message,) = ran.host.of("message")
    assert (message["kind"], message["text"]) == ("error", "no arm")
    assert message["location"] == {"file": str(tmp_path / "plugin.py"), "line": 5}


def test_except_exception_does_not_swallow_an_assertion(tmp_path: Path) -> None:
    body = "try:\n    self.require(False, 'ready')\nexcept Exception:\n    self.report('swallowed')"
    ran = run(tmp_path, arm(body))
    assert ran.texts == [("failure", "ready")]


def test_a_bare_except_does_not_turn_a_failure_into_a_pass(tmp_path: Path) -> None:
    body = "try:\n    self.require(False, 'ready')\nexcept:\n    self.report('swallowed')"
    ran = run(tmp_path, arm(body))
    assert ran.texts == [("failure", "ready"), ("report", "swallowed")]
    assert ran.result == {"outcome": "failed"}


def test_a_critical_assertion_says_so(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("self.require_critical(False, 'emergency stop')"))
    assert ran.host.of("message")[0]["critical"] is True
    assert ran.result == {"outcome": "failed"}


@pytest.mark.parametrize(
    ("body", "result"),
    [
        ("return False", {"outcome": "error", "reason": "setup returned false"}),
        ("self.check(False, 'power')", {"outcome": "failed"}),
        ("self.require(False, 'power')", {"outcome": "failed"}),
        ("raise OSError(5, 'no bus')", {"outcome": "error"}),
    ],
)
def test_after_a_problem_in_setup_run_is_not_called(
    tmp_path: Path, body: str, result: dict[str, str]
) -> None:
    setup = f"    def setup(self, args):\n        {body}\n{TEAR_DOWN}"
    ran = run(tmp_path, arm("self.report('never')", setup))
    assert ran.result == result
    assert ran.phases == ["setup", "tear-down"]
    assert ran.texts[-1] == ("report", "torn down")


@pytest.mark.parametrize("returned", ["True", "None", "0", "''"])
def test_only_false_fails_a_setup(tmp_path: Path, returned: str) -> None:
    setup = f"    def setup(self, args):\n        return {returned}\n"
    assert run(tmp_path, arm("pass", setup)).result == {"outcome": "passed"}


def test_a_problem_in_tear_down_does_not_pass(tmp_path: Path) -> None:
    tear_down = "    def tearDown(self):\n        self.check(False, 'parked')\n"
    ran = run(tmp_path, arm("pass", tear_down))
    assert ran.result == {"outcome": "failed"}
    assert ran.texts == [("failure", "parked")]


def test_a_measurement_outside_its_limits_does_not_pass(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("self.measure('rate', 87.5, 'Hz', 95, 105)\nself.report('on')"))
    assert ran.result == {"outcome": "failed"}
    assert ran.texts == [("report", "on")]


@pytest.mark.parametrize("definition", ["async def run(self): pass", "def run(self): yield"])
def test_a_run_that_nobody_carries_out_does_not_pass(tmp_path: Path, definition: str) -> None:
    ran = run(tmp_path, f"class Arm(rtf.TestCase):\n    {definition}\n")
    assert ran.result == {"outcome": "error"}
    assert "coroutine" in ran.texts[0][1]


def test_a_thread_that_ends_with_an_exception_is_an_error(tmp_path: Path) -> None:
    body = (
        "import threading\n"
        "thread = threading.Thread(target=lambda: 1 / 0)\n"
        "thread.start()\n"
        "thread.join()"
    )
    ran = run(tmp_path, arm(body))
    assert ran.result == {"outcome": "error"}
    assert ran.problem == ("error", "ZeroDivisionError: division by zero")


def test_sys_exit_ends_the_process_without_an_answer(tmp_path: Path) -> None:
    ran = run(tmp_path, arm("self.check(False, 'wrong')\nraise SystemExit(0)"))
    assert ran.result is None
    assert ran.texts == [("failure", "wrong")]
    assert ran.code == 0


def test_exit_functions_run_and_set_the_exit_code(tmp_path: Path) -> None:
    body = "import atexit, os\natexit.register(lambda: (print('bye', flush=True), os._exit(3)))"
    ran = run(tmp_path, arm(body))
    assert ran.result == {"outcome": "passed"}
    assert (ran.code, ran.output) == (3, "bye\n")
