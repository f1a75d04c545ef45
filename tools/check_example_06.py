#!/usr/bin/env python3
"""Runs the suites of example 06 side by side, as a user does, and kills a node of one.

    check_example_06.py RTF LEFT RIGHT

The first runs are made in a network namespace with a second interface, which
stands for the network that the machine is in: no packet may leave by it. Two
suites that share a domain prove that they would hear each other otherwise, and
that the packets are counted.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from check_example_01 import Event, Run, expect, is_a
from check_fixture_ros2launch import pids, shared_memory

OUTSIDE = "out"
"""The interface that leads out of the namespace."""

SETTLE = f"""
set -e
ip link set lo up
ip link add {OUTSIDE} type veth peer name far
# Without IPv6 addresses, which say hello by themselves.
ip link set {OUTSIDE} addrgenmode none
ip link set far addrgenmode none
ip addr add 10.99.0.1/24 dev {OUTSIDE}
ip link set {OUTSIDE} up
ip link set far up
ip route add default dev {OUTSIDE}
exec "$@"
"""


def main() -> int:
    """Runs all and tells the first thing that is not as it should be."""
    if sys.argv[1] == "--inside":
        return inside(*sys.argv[2:])
    arguments = [str(Path(argument).resolve()) for argument in sys.argv[1:]]
    before = shared_memory()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["ROS_LOG_DIR"] = folder
        os.environ.pop("ROS_DOMAIN_ID", None)
        os.environ.pop("ROS_AUTOMATIC_DISCOVERY_RANGE", None)
        script = [sys.executable, __file__, "--inside", folder, *arguments]
        unshare = ["unshare", "--net", *(["--map-root-user"] if os.geteuid() else [])]
        subprocess.run([*unshare, "sh", "-c", SETTLE, "sh", *script], check=True)
        killed(Path(folder), *arguments)
        expect("nodes left", pids("joint.py"), [])
        expect("shared memory left", shared_memory() - before, set())
    return 0


def inside(folder: str, rtf: str, left: str, right: str) -> int:
    """The runs whose packets are counted."""
    apart(Path(folder), rtf, left, right)
    together(Path(folder), rtf, left, right)
    return 0


def apart(folder: Path, rtf: str, left: str, right: str) -> None:
    """Side by side, neither hears the other, and nobody outside hears them."""
    before = packets()
    run = Run(rtf, left, folder / "apart", "--jobs", "2", right)
    expect("exit code", run.wait(), 0)
    verdicts = outcomes(run)
    expect("tests", len(verdicts), 8)
    expect("verdicts", {verdict for _, _, verdict in verdicts}, {"passed"})
    expect("suites side by side", side_by_side(run), True)
    expect("packets that left", packets() - before, 0)
    expect("nodes left", pids("joint.py"), [])


def together(folder: Path, rtf: str, left: str, right: str) -> None:
    """In one domain, with the default discovery, they hear each other, and others them."""
    before = packets()
    os.environ["ROS_DOMAIN_ID"] = "99"
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "SUBNET"
    only = ["--set", "seconds=8", "--filter", "name(AloneTest)", "--jobs", "2", right]
    run = Run(rtf, left, folder / "together", *only)
    expect("exit code in one domain", run.wait(), 1)
    heard = [each for each in outcomes(run) if each[2] == "failed"]
    expect("who is not alone, at least one", len(heard) > 0, True)
    expect("packets that left, more than none", packets() - before > 0, True)


def killed(folder: Path, rtf: str, left: str, right: str) -> None:
    """A node of the left suite is killed: its test collapses, and nothing of the right one."""
    run = Run(rtf, left, folder / "killed", "--jobs", "2", right)
    try:
        run.wait_for(lambda event: is_running(run, event))
        (joint,) = (pid for pid in pids("joint.py") if robot(pid) == "left")
        os.kill(joint, signal.SIGKILL)
        run.wait_for(lambda event: is_a(event, "fixture-collapsed"))
    except BaseException:
        run.stop()
        raise
    expect("exit code", run.wait(), 1)
    (reason,) = [event["reason"] for event in run.events() if is_a(event, "fixture-collapsed")]
    expect(f"SIGKILL in `{reason}`", "SIGKILL" in reason or "signal 9" in reason, True)
    verdicts = outcomes(run)
    collapsed = [(suite, test) for suite, test, verdict in verdicts if verdict == "collapsed"]
    expect("collapsed", collapsed, [("left", "TopicTest")])
    expect("passed", sum(verdict == "passed" for _, _, verdict in verdicts), 7)
    output = (event["text"] for event in run.events() if is_a(event, "output"))
    cleaned = any("removed /dev/shm/fastdds_" in text for text in output)
    expect("what the dead node left is removed", cleaned, True)


def is_running(run: Run, event: Event) -> bool:
    """Whether the left suite's test of topics has begun its run."""
    if not (is_a(event, "test-phase") and event["phase"] == "run"):
        return False
    return names(run)[event["test"]] == ("left", "TopicTest")


def names(run: Run) -> dict[int, tuple[str, str]]:
    """Suite and name of each test."""
    events = list(run.events())
    suites = {each["suite"]: each["name"] for each in events if is_a(each, "suite-planned")}
    planned = (each for each in events if is_a(each, "test-planned"))
    return {each["test"]: (suites[each["suite"]], each["name"]) for each in planned}


def outcomes(run: Run) -> list[tuple[str, str, str]]:
    """Suite, name and verdict of each test that has ended."""
    known = names(run)
    finished = (event for event in run.events() if is_a(event, "test-finished"))
    return [(*known[event["test"]], event["verdict"]) for event in finished]


def side_by_side(run: Run) -> bool:
    """Whether both suites began before one had ended."""
    kinds = [event["type"] for event in run.events()]
    order = [kind for kind in kinds if kind in {"suite-started", "suite-finished"}]
    return order[:2] == ["suite-started", "suite-started"]


def robot(pid: int) -> str:
    """The robot to which a joint belongs."""
    variables = Path(f"/proc/{pid}/environ").read_text().split("\0")
    return next(each.partition("=")[2] for each in variables if each.startswith("ROBOT="))


def packets() -> int:
    """How many packets have left by the interface that leads out."""
    for line in Path("/proc/net/dev").read_text().splitlines():
        interface, _, numbers = line.partition(":")
        if interface.strip() == OUTSIDE:
            return int(numbers.split()[9])
    raise SystemExit(f"there is no interface {OUTSIDE}")


if __name__ == "__main__":
    sys.exit(main())
