"""Runs the suites of example 06 in parallel, as a user does, and kills a node of one.

No packet may leave the machine. A run with a shared domain proves that without isolation
the suites hear each other and other machines hear them.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import network
import pytest
from checkout import ROOT
from fastdds import left, private_memory
from pages import run_fixture_page
from processes import kill, running, variable
from run import Event, Run, expect, expect_in, is_a

pytestmark = [pytest.mark.middleware("ros2"), pytest.mark.outside_network]
EXAMPLE = ROOT / "examples/06-ros2"
LEFT, RIGHT = str(EXAMPLE / "left.xml"), str(EXAMPLE / "right.xml")
OWN = ("ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE")
"""The isolation of each suite: its domain, and discovery on this machine only."""


@pytest.fixture
def rtf(rtf: str, tmp_path: Path) -> Iterator[str]:
    """The program, with separate shared memory."""
    with private_memory(rtf, tmp_path / "program") as program:
        yield program


@pytest.fixture(autouse=True)
def _nothing_is_left(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    for name in (*OWN, "ROS_LOG_DIR"):
        monkeypatch.delenv(name, raising=False)
    yield
    expect("nodes left", running("joint.py"), [])


def test_suites_do_not_hear_each_other(rtf: str, tmp_path: Path) -> None:
    """In parallel, and no packet leaves the machine."""
    with network.quiet("lesson 6"):
        run = Run(rtf, LEFT, tmp_path / "results", "--jobs", "2", RIGHT)
        expect("exit code", run.wait(), 0)
    verdicts = outcomes(run)
    expect("tests", len(verdicts), 8)
    expect("verdicts", {verdict for _, _, verdict in verdicts}, {"passed"})
    expect("suites in parallel", are_parallel(run), True)
    logs = run.journal.parent / "logs"
    logged = [any((logs / f"{suite}.ros").glob("python*.log")) for suite in ("left", "right")]
    expect("the nodes' logs are in the results", logged, [True, True])
    expect("nodes left", running("joint.py"), [])


def test_suites_in_one_domain_hear_each_other(
    rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With default discovery, packets leave."""
    before = network.packets()
    for name, value in zip(OWN, ("99", "SUBNET"), strict=True):
        monkeypatch.setenv(name, value)
    only = ["--set", "seconds=8", "--filter", "name(AloneTest)", "--jobs", "2", RIGHT]
    run = Run(rtf, LEFT, tmp_path / "results", *only)
    expect("exit code in one domain", run.wait(), 1)
    heard = [each for each in outcomes(run) if each[2] == "failed"]
    expect("arms that are not alone, at least one", len(heard) > 0, True)
    expect("packets that left, at least one", network.packets() - before > 0, True)
    expect("shared memory left", left(rtf), [])


def test_a_killed_node_is_a_collapse_of_its_suite_only(rtf: str, tmp_path: Path) -> None:
    with network.quiet("lesson 6"):
        run = Run(rtf, LEFT, tmp_path / "results", "--jobs", "2", RIGHT)
        try:
            run.wait_for(lambda event: is_running(run, event))
            kill([joint for joint in running("joint.py") if variable(joint, "ROBOT") == "left"])
        except BaseException:
            run.stop()
            raise
        expect("exit code", run.wait(), 1)
    expect_in("SIGKILL", run.reason())
    verdicts = outcomes(run)
    collapsed = [(suite, test) for suite, test, verdict in verdicts if verdict == "collapsed"]
    expect("collapsed", collapsed, [("left", "TopicTest")])
    expect("passed", sum(verdict == "passed" for _, _, verdict in verdicts), 7)
    told = (event["text"] for event in run.events("output"))
    cleaned = any("removed /dev/shm/fastdds_" in text for text in told)
    expect("shared memory of the dead node is removed", cleaned, True)


def test_page(rtf: str, tmp_path: Path) -> None:
    with network.quiet("lesson 6"):
        run_fixture_page(rtf, "ros2launch", tmp_path / "page", EXAMPLE)


def is_running(run: Run, event: Event) -> bool:
    """Whether the left suite's TopicTest has reached the phase `run`."""
    if not (is_a(event, "test-phase") and event["phase"] == "run"):
        return False
    return names(run)[event["test"]] == ("left", "TopicTest")


def names(run: Run) -> dict[int, tuple[str, str]]:
    """Suite and name of each test."""
    suites = {each["suite"]: each["name"] for each in run.events("suite-planned")}
    planned = run.events("test-planned")
    return {each["test"]: (suites[each["suite"]], each["name"]) for each in planned}


def outcomes(run: Run) -> list[tuple[str, str, str]]:
    """Suite, name and verdict of each finished test."""
    known = names(run)
    finished = run.events("test-finished")
    return [(*known[event["test"]], event["verdict"]) for event in finished]


def are_parallel(run: Run) -> bool:
    """Whether both suites started before one finished."""
    kinds = [event["type"] for event in run.events()]
    order = [kind for kind in kinds if kind in {"suite-started", "suite-finished"}]
    return order[:2] == ["suite-started", "suite-started"]
