"""Runs the fixture `ros2launch` while its nodes are killed, stopped and missing.

The nodes are real. There are no packages of the `ros2` command, so a substitute starts
them and reproduces the recorded behaviour of the real command.
"""

from __future__ import annotations

import shutil
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from checkout import ROOT, call
from fastdds import left, private_memory
from processes import kill, running
from run import Run, expect, expect_in

pytestmark = pytest.mark.middleware("ros2")
SUITES = ROOT / "tests/fixtures/ros2launch"
SUITE = str(SUITES / "suite.xml")
SECONDS = "--set=seconds=15"
"""How long the first test listens, in seconds: long enough to disturb it."""


@pytest.fixture
def rtf(rtf: str, tmp_path: Path) -> Iterator[str]:
    """The program, with separate shared memory."""
    with private_memory(rtf, tmp_path / "program") as program:
        yield program


@pytest.fixture(autouse=True)
def _nothing_is_left(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    for name in ("ROS_DOMAIN_ID", "ROS_LOG_DIR"):
        monkeypatch.delenv(name, raising=False)
    yield
    expect("nodes left", running("talker.py"), [])


@pytest.fixture
def ros2(monkeypatch: pytest.MonkeyPatch) -> None:
    """The command `ros2` is on PATH."""
    monkeypatch.setenv("PATH", str(SUITES / "bin"), prepend=":")


def test_a_missing_command_is_named(rtf: str, tmp_path: Path) -> None:
    """With where it is from."""
    found = shutil.which("ros2")
    assert found is None, f"{found} is on PATH: this check needs a PATH without it"
    run = Run(rtf, SUITE, tmp_path / "results")
    expect("exit code without ros2", run.wait(), 1)
    told = run.reason("fixture-broken")
    expect_in("set-up failed: there is no program `ros2` on PATH", told)
    expect_in("https://docs.ros.org", told)


def test_a_program_of_signals_hears_earlier_messages_and_leaves(tmp_path: Path) -> None:
    """It also hears a publisher that comes later and offers less."""
    with private_memory(shutil.which("python3") or "", tmp_path / "program") as python:
        call(
            python,
            Path(__file__).with_name("hidden_nodes.py"),
            ROOT / "fixtures/rtf_fixtures/ros2_signals.py",
            PYTHONPATH=str(ROOT / "tests/harness"),
            ROS_DOMAIN_ID="97",
            ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST",
        )


@pytest.mark.usefixtures("ros2")
def test_all_pass(rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also with a process that exits successfully.

    The process has the name of its node, one topic was published once, before anyone listened and
    long before the end, and the user prefers other messages of launch.
    """
    options = "--process speaker --topic /description --topic /chatter --silence 2"
    messages = "{name} ({levelname}) \\x1b[31m{msg}\\x1b[0m"
    monkeypatch.setenv("OVERRIDE_LAUNCH_SCREEN_FORMAT", messages)
    settings = ["file=named.launch.xml", f"options={options}", "seconds=4"]
    run = Run(rtf, SUITE, tmp_path / "results", *(f"--set={each}" for each in settings))
    expect("exit code", run.wait(), 0)
    expect("verdicts", set(run.verdicts().values()), {"passed"})
    expect("nodes left", running("talker.py"), [])


@pytest.mark.usefixtures("ros2")
@pytest.mark.parametrize(
    ("number", "reason"),
    [
        pytest.param(signal.SIGKILL, "talker-1 was killed by SIGKILL", id="killed"),
        pytest.param(signal.SIGSTOP, "no message on /chatter for 2 s", id="silent"),
    ],
)
def test_after_a_collapse_there_is_a_new_node(
    rtf: str, tmp_path: Path, number: signal.Signals, reason: str
) -> None:
    run = Run(rtf, SUITE, tmp_path / "results", SECONDS)
    run.collapses(lambda: kill(running("talker.py"), number))
    expect(f"exit code after {number.name}", run.wait(), 1)
    expect("verdicts", list(run.verdicts().values()), ["collapsed", "passed"])
    expect("reason", run.reason(), reason)
    expect("starts", len(list(run.events("fixture-ready"))), 2)
    expect("nodes left", running("talker.py"), [])


@pytest.mark.usefixtures("ros2")
def test_rtf_kills_the_nodes_of_a_killed_launch(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, SUITE, tmp_path / "results", SECONDS)
    run.collapses(lambda: kill(running("ros2")))
    expect("exit code", run.wait(), 1)
    expect("reason", run.reason(), "ros2 was killed by SIGKILL")
    expect("verdicts", list(run.verdicts().values()), ["collapsed", "passed"])
    expect("nodes left", running("talker.py"), [])


@pytest.mark.usefixtures("ros2")
def test_the_end_of_a_required_process_is_a_collapse(rtf: str, tmp_path: Path) -> None:
    """At once, and it shuts launch down."""
    run = Run(rtf, SUITE, tmp_path / "results", SECONDS, "--set=file=required.launch.xml")
    run.collapses(lambda: kill(running("ends.py"), signal.SIGTERM))
    expect("exit code", run.wait(), 1)
    ended = "planner-2 ended with exit code 0, and launch shuts down because it was required"
    expect("reason", run.reason(), ended)
    expect("verdicts", list(run.verdicts().values()), ["collapsed", "passed"])


@pytest.mark.usefixtures("ros2")
@pytest.mark.parametrize(
    ("reason", "settings"),
    [
        pytest.param(
            "talker-1 ended with exit code 1: ValueError: could not convert string to float: "
            "'fast'",
            ["rate=fast"],
            id="early",
        ),
        pytest.param(
            "driver-2 was not started: FileNotFoundError: [Errno 2] No such file or directory: "
            "'./no-such-driver'",
            ["file=missing.launch.xml"],
            id="missing",
        ),
        pytest.param(
            "Failed to load node 'driver' of type 'arm::Driver' in container '/box': Failed to "
            "find class with the requested plugin name.",
            ["file=component.launch.xml"],
            id="component",
        ),
        pytest.param(
            "a message on /chatter for a new subscriber: not within 8 s (started: talker-1)",
            ["file=once.launch.xml", "options=--topic /chatter --timeout 8"],
            id="once",
        ),
        pytest.param(
            "the start of speaker: not within 2 s (started: talker-1, calibration-2)",
            ["options=--process speaker --timeout 2"],
            id="unnamed",
        ),
    ],
)
def test_the_line_that_says_why_a_start_fails_is_shown_once(
    rtf: str, tmp_path: Path, reason: str, settings: list[str]
) -> None:
    run = Run(rtf, SUITE, tmp_path / "results", *(f"--set={each}" for each in settings))
    expect("exit code", run.wait(), 1)
    expect("reason", run.reason("fixture-broken"), f"set-up failed: {reason}")
    first = "[INFO] [launch]: Default logging verbosity"
    # A talker that is interrupted while it starts prints so much that the first line is cut.
    shown = run.output.read_text()
    expect("the output is shown once", shown.count("last lines:"), 1)
    expect("no line is shown twice", shown.count(first) <= 1, True)


@pytest.mark.usefixtures("ros2")
def test_a_crash_while_launch_shuts_down_is_a_problem(rtf: str, tmp_path: Path) -> None:
    run = Run(rtf, SUITE, tmp_path / "results", "--set=file=crash.launch.xml")
    expect("exit code", run.wait(), 1)
    expect("verdicts", set(run.verdicts().values()), {"passed"})
    (problem,) = run.problems()
    shut = "while launch shut down, "
    expect_in(f"{shut}driver-2 was killed by SIGSEGV: it ends with SIGSEGV", problem)
    expect_in(f"{shut}logger-3 ended with exit code 7: it ends with 7", problem)


@pytest.mark.usefixtures("ros2")
def test_a_process_may_crash_if_that_is_allowed(rtf: str, tmp_path: Path) -> None:
    options = "options=--process talker --may-die gripper --may-die logger"
    settings = ["--set=file=crash.launch.xml", f"--set={options}"]
    run = Run(rtf, SUITE, tmp_path / "results", *settings)
    expect("exit code", run.wait(), 0)
    expect("shared memory left", left(rtf), [])
