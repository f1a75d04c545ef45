#!/usr/bin/env python3
"""Runs the suites of example 06 in parallel, as a user does, and kills a node of one.

    check_example_06.py RTF LEFT RIGHT

No packet may leave the machine. A run with a shared domain proves that without isolation
the suites hear each other and other machines hear them.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

import network
from pages import run_fixture_page
from processes import kill, running, shared_memory, variable
from run import Event, Run, expect, expect_in, is_a

OWN = ("ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE")
"""The isolation of each suite: its domain, and discovery on this machine only."""


def main() -> int:
    """Runs all; exits at the first difference."""
    network.move_in()
    arguments = [str(Path(argument).resolve()) for argument in sys.argv[1:]]
    before = shared_memory()
    for name in (*OWN, "ROS_LOG_DIR"):
        os.environ.pop(name, None)
    with tempfile.TemporaryDirectory() as directory:
        with network.quiet("lesson 6"):
            apart(Path(directory), *arguments)
            killed(Path(directory), *arguments)
            lesson = Path(arguments[1]).parent
            run_fixture_page(arguments[0], "ros2launch", Path(directory) / "page", lesson)
        together(Path(directory), *arguments)
        expect("nodes left", running("joint.py"), [])
        expect("shared memory left", shared_memory() - before, set())
    return 0


def apart(directory: Path, rtf: str, left: str, right: str) -> None:
    """In parallel, neither suite hears the other, and no packet leaves the machine."""
    run = Run(rtf, left, directory / "apart", "--jobs", "2", right)
    expect("exit code", run.wait(), 0)
    verdicts = outcomes(run)
    expect("tests", len(verdicts), 8)
    expect("verdicts", {verdict for _, _, verdict in verdicts}, {"passed"})
    expect("suites in parallel", are_parallel(run), True)
    logs = run.journal.parent / "logs"
    logged = [any((logs / f"{suite}.ros").glob("python*.log")) for suite in ("left", "right")]
    expect("the nodes' logs are in the results", logged, [True, True])
    expect("nodes left", running("joint.py"), [])


def together(directory: Path, rtf: str, left: str, right: str) -> None:
    """In one domain with default discovery, they hear each other, and packets leave."""
    before = network.packets()
    os.environ.update(zip(OWN, ("99", "SUBNET"), strict=True))
    only = ["--set", "seconds=8", "--filter", "name(AloneTest)", "--jobs", "2", right]
    run = Run(rtf, left, directory / "together", *only)
    expect("exit code in one domain", run.wait(), 1)
    heard = [each for each in outcomes(run) if each[2] == "failed"]
    expect("arms that are not alone, at least one", len(heard) > 0, True)
    expect("packets that left, at least one", network.packets() - before > 0, True)


def killed(directory: Path, rtf: str, left: str, right: str) -> None:
    """A node of the left suite is killed: its test collapses, and the right suite is unaffected."""
    run = Run(rtf, left, directory / "killed", "--jobs", "2", right)
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


if __name__ == "__main__":
    sys.exit(main())
