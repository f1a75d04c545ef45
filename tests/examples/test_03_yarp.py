"""Runs example 03 as a user does, and while parts of the robot are killed.

A module, the name server and the fixture get a SIGKILL, and YARP's tool cuts a connection. No
packet may leave the machine.
"""

from __future__ import annotations

import shlex
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from checkout import ROOT
from cpp_plugins import plugins
from pages import run_fixture_page
from processes import kill, parent
from run import Run, expect, expect_in
from yarp_runs import YarpRuns, quiet_runs

pytestmark = [pytest.mark.middleware("yarp"), pytest.mark.outside_network]
EXAMPLE = ROOT / "examples/03-yarp"
VICTIM = "StreamTest"
CONNECTION = "/sensor/values:o -> /smoother/values:i"


@pytest.fixture(autouse=True)
def runs(rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[YarpRuns]:
    """The environment is that of the lesson."""
    monkeypatch.setenv("RTF_DIR", str(ROOT / "sdk/cpp/cmake/rtf"))
    built = plugins("03-yarp")
    monkeypatch.setenv("RTF_PLUGIN_PATH", str(built))
    monkeypatch.setenv("PATH", str(built), prepend=":")
    with quiet_runs(rtf, EXAMPLE, tmp_path) as started:
        yield started


@pytest.mark.parametrize(("suite", "tests"), [("first_generation.xml", 2), ("yarp.xml", 3)])
def test_all_pass_and_nothing_is_left(runs: YarpRuns, suite: str, tests: int) -> None:
    run = runs.start(suite)
    expect("exit code", run.wait(), 0)
    expect("verdicts", list(run.verdicts().values()), ["passed"] * tests)
    runs.nothing_left()


def kill_sensor(runs: YarpRuns, _: Run) -> None:
    """A module of the robot dies."""
    kill(runs.processes("sensor"))


def cut_connection(_: YarpRuns, run: Run) -> None:
    """A connection is cut."""
    source, target = CONNECTION.split(" -> ")
    (join,) = [event["join_command"] for event in run.events("suite-prepared")]
    words = [word for word in shlex.split(join) if word != "${SHELL:-sh}"]
    subprocess.run([*words, "yarp", "disconnect", source, target], check=True, timeout=30)


def kill_server(runs: YarpRuns, _: Run) -> None:
    """The name server dies."""
    kill(runs.processes("yarpserver"))


def kill_fixture(runs: YarpRuns, _: Run) -> None:
    """The plug-in that runs YARP's manager dies."""
    (manager,) = runs.processes("yarpmanager-console")
    kill([parent(manager)])


@pytest.mark.parametrize(
    ("disturb", "expected"),
    [
        pytest.param(kill_sensor, ["module `sensor --name /sensor`"], id="module"),
        pytest.param(cut_connection, [CONNECTION, "does not send"], id="connection"),
        pytest.param(kill_server, ["yarpserver was killed by SIGKILL"], id="server"),
        pytest.param(kill_fixture, ["SIGKILL"], id="fixture"),
    ],
)
def test_a_collapse_names_the_lost_part(
    runs: YarpRuns, disturb: Callable[[YarpRuns, Run], None], expected: list[str]
) -> None:
    """The running test is `collapsed`, and the others pass."""
    run = runs.start("yarp.xml")

    def do() -> None:
        expect("interfaces", interfaces(run), ["lo"])
        disturb(runs, run)

    noticed = run.collapses(do, VICTIM)
    expect("exit code", run.wait(), 1)
    expect("seconds until the collapse was detected, below 3", noticed < 3, True)
    verdicts = run.verdicts()
    expect(f"verdict of {VICTIM}", verdicts.pop(VICTIM), "collapsed")
    expect("other verdicts", list(verdicts.values()), ["passed", "passed"])
    for text in expected:
        expect_in(text, run.reasons()[0])
    runs.nothing_left()


@pytest.mark.parametrize("page", ["yarpserver", "yarpmanager", "yarpplugin", "yarpdatadumper"])
def test_page(runs: YarpRuns, page: str) -> None:
    run_fixture_page(runs.rtf, page, runs.directory / page, EXAMPLE)
    runs.nothing_left()


def interfaces(run: Run) -> list[str]:
    """The network interfaces that are visible to the suite's processes."""
    (network,) = [event["network"] for event in run.events("suite-prepared")]
    lines = Path(f"/proc/{network['pid']}/net/dev").read_text().splitlines()[2:]
    return [line.split(":")[0].strip() for line in lines]
