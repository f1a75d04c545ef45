"""Runs example 05 as a user does, and while parts of ROS are killed.

roscore, roslaunch and nodes get a SIGKILL during a test. No packet may leave the machine.
"""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from pathlib import Path

import network
import pytest
from checkout import BUILD, ROOT
from cpp_plugins import plugins
from pages import run_fixture_page
from processes import MARK, children, commands, kill, parent, select
from run import Event, Run, expect, is_a

pytestmark = [pytest.mark.middleware("ros1"), pytest.mark.outside_network]
EXAMPLE = ROOT / "examples/05-ros1"
ROVER = EXAMPLE / "rover.xml"
SLIPPING = EXAMPLE / "slipping.xml"
PROBES = ROOT / "tests/fixtures/ros1/probes.xml"
VICTIM = "RateTest"
RUNNER_DIED = 5
LONG = "--set=seconds=20"
"""How long the victim listens, in seconds: long enough to disturb it."""

MAY_DIE = "--may-die lidar --may-die camera"

BROKEN = """<launch>
  <node name="wheel" pkg="rover" type="wheel.py"/>
  <node name="rudder" pkg="rover" type="rudder.py"/>
</launch>
"""
BROKEN_SUITE = """<suite name="broken">
  <fixture param="broken.launch"> roslaunch </fixture>
  <test> Never.py </test>
</suite>
"""
ENDING = """<launch>
  <node name="arm" pkg="ending" type="node.py" args="0"/>
  <node name="lidar" pkg="ending" type="node.py" args="11" respawn="true"/>
  <node name="camera" pkg="ending" type="node.py" args="3"/>
</launch>
"""
ENDING_SUITE = """<suite name="ending">
  <env name="ROS_PACKAGE_PATH" value="{packages}"/>
  <fixture param="ending/ending.launch {options}"> roslaunch </fixture>
  <test> Never.py </test>
</suite>
"""
ENDING_NODE = """#!/usr/bin/python3
# Ends with an exit code, or by a signal, when it is stopped.
import os, sys, rospy
rospy.init_node("node")
how = int(sys.argv[1])
rospy.spin()
if how == 11:
    os.kill(os.getpid(), how)
sys.exit(how)
"""
NEVER = "import rtf\nclass Never(rtf.TestCase):\n    def run(self):\n        pass\n"


class Scene:
    """Runs of rtf, each with a private ROS master."""

    def __init__(self, rtf: str, directory: Path) -> None:
        self.rtf = rtf
        self.directory = directory
        self.runs: list[Run] = []

    @property
    def run(self) -> Run:
        """The newest run."""
        return self.runs[-1]

    def start(self, suite: Path, *options: str) -> None:
        """Starts a run."""
        results = self.directory / f"run-{len(self.runs)}"
        self.runs.append(Run(self.rtf, str(suite), results, *options))

    def kill(self, word: str, number: signal.Signals = signal.SIGKILL) -> None:
        """Sends a signal to a ROS process while the victim runs."""
        self.disturb(lambda: kill(self.processes(word), number))

    def disturb(self, disturbance: Callable[[], None]) -> None:
        """Disturbs the run while the victim runs."""
        self.run.disturb(disturbance, VICTIM)

    def finish(self, code: int) -> None:
        """Waits until the run ends; no ROS process is left."""
        expect("exit code", self.run.wait(), code)
        expect("processes left", commands(self.processes()), [])

    def processes(self, word: str = "") -> list[int]:
        """The processes that use this run's master, or those whose command lines contain a word."""
        # Runs in other networks may have the same port.
        ours = {self.master(), f"{MARK}={os.environ[MARK]}"}
        return select(
            lambda _, words, variables: ours <= set(variables) and word in " ".join(words)
        )

    def master(self) -> str:
        """The variable with the address of this run's master."""
        (prepared,) = self.events("suite-prepared")
        values = {each["name"]: each["value"] for each in prepared["variables"]}
        return f"ROS_MASTER_URI={values['ROS_MASTER_URI']}"

    def events(self, kind: str) -> list[Event]:
        """The events of a kind."""
        return list(self.run.events(kind))

    def collapsed(self, reason: str) -> None:
        """The victim is `collapsed` with this reason; the other tests pass."""
        self.finish(1)
        expect("reason", self.run.reasons(), [reason])
        verdicts = self.run.verdicts()
        expect(f"verdict of {VICTIM}", verdicts.pop(VICTIM), "collapsed")
        expect("other verdicts", set(verdicts.values()), {"passed"})


@pytest.fixture(autouse=True)
def scene(rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Scene]:
    """The environment is that of the lesson; logs are only in the results."""
    home = tmp_path / "home"
    monkeypatch.setenv("ROS_HOME", str(home))
    monkeypatch.setenv("RTF_PLUGIN_PATH", str(plugins("05-ros1")))
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"{BUILD / 'examples/05-ros1'}:/usr/share")
    for name in ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_IP", "ROS_LOG_DIR"):
        monkeypatch.delenv(name, raising=False)
    with network.quiet("lesson 5") if network.is_inside() else nullcontext():
        played = Scene(rtf, tmp_path)
        yield played
        for run in played.runs:
            run.stop()
    expect("logs in ROS_HOME", list(home.rglob("*.log*")), [])


def broken(directory: Path) -> Path:
    """A suite whose launch file names a missing node."""
    (directory / "broken.launch").write_text(BROKEN)
    (directory / "Never.py").write_text(NEVER)
    suite = directory / "broken.xml"
    suite.write_text(BROKEN_SUITE)
    return suite


def ending(directory: Path, name: str, options: str) -> Path:
    """A suite with a package of nodes that end in different ways when they are stopped."""
    package = directory / name / "ending"
    package.mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>ending</name></package>")
    (package / "ending.launch").write_text(ENDING)
    node = package / "node.py"
    node.write_text(ENDING_NODE)
    node.chmod(0o755)
    (directory / name / "Never.py").write_text(NEVER)
    suite = directory / name / f"{name}.xml"
    suite.write_text(ENDING_SUITE.format(packages=f"{package.parent}:/usr/share", options=options))
    return suite


def test_two_runs_pass_with_separate_masters(scene: Scene) -> None:
    masters = set()
    for _ in range(2):
        scene.start(ROVER)
        scene.run.wait_for(lambda event: is_a(event, "suite-prepared"))
        masters.add(scene.master())
    expect("masters", len(masters), 2)
    while scene.runs:
        scene.finish(0)
        expect("verdicts", list(scene.run.verdicts().values()), ["passed"] * 3)
        scene.runs.pop()


@pytest.mark.parametrize("page", ["roscore", "roslaunch", "rosbag"])
def test_page(scene: Scene, page: str) -> None:
    lesson = None if page == "roscore" else EXAMPLE
    run_fixture_page(scene.rtf, page, scene.directory / page, lesson)


def test_a_respawned_node_is_reported(scene: Scene) -> None:
    """The wheel dies and roslaunch restarts it: this is reported, and nothing collapses."""
    scene.start(ROVER, LONG)
    scene.kill("wheel.py")
    scene.finish(0)
    sent = " ".join(str(event["message"]["text"]) for event in scene.events("message"))
    expect("reported", "node /rover/wheel was killed by SIGKILL (exit code -9)" in sent, True)
    expect("reported", "node /rover/wheel was started again by roslaunch" in sent, True)
    expect("collapses", scene.run.reasons(), [])


def test_a_respawn_that_is_not_allowed_is_a_collapse(scene: Scene) -> None:
    """Without `--allow-respawn`, the same is a collapse."""
    scene.start(ROVER, LONG, "--set=respawn=")
    scene.kill("wheel.py")
    scene.collapsed(
        "node /rover/wheel was killed by SIGKILL (exit code -9) "
        "(`--allow-respawn` tolerates that of respawned nodes)"
    )


def test_the_death_of_a_required_node_is_a_collapse(scene: Scene) -> None:
    """A required node dies, and roslaunch exits with 0: this is a collapse."""
    scene.start(ROVER, LONG)
    scene.kill("rover/odometer")
    scene.collapsed("node /rover/odometer was killed by SIGKILL (exit code -9)")
    expect("starts", len(scene.events("fixture-ready")), 3)
    # The logs of both starts are in the results.
    logs = scene.run.journal.parent / "logs" / "rover.ros"
    starts = {path.parent for path in logs.glob("*/rover-wheel-*.log")}
    expect("directories with the logs of nodes", len(starts), 2)


def test_a_killed_master_is_a_collapse(scene: Scene) -> None:
    """The death of the master is detected, and the fixtures that depend on it are restarted."""
    scene.start(ROVER, LONG)
    scene.kill("rosmaster")
    scene.collapsed("the master was killed by SIGKILL (exit code -9)")
    expect("starts", len(scene.events("fixture-ready")), 4)


def test_rtf_kills_the_nodes_of_a_killed_roslaunch(scene: Scene) -> None:
    """Its nodes are separate sessions and survive it; rtf kills them."""
    scene.start(ROVER, LONG)
    scene.kill("bin/roslaunch")
    scene.collapsed("roslaunch was killed by SIGKILL")


def test_a_hung_node_is_detected_before_a_test(scene: Scene) -> None:
    """A hung node has a process and is in the master's list: `check` before a test detects it."""
    scene.start(ROVER)
    scene.kill("rover/odometer", signal.SIGSTOP)
    scene.finish(1)
    (reason,) = scene.run.reasons()
    expect(f"the node in {reason!r}", "node /rover/odometer: nobody answers" in reason, True)
    verdicts = list(scene.run.verdicts().values())
    expect("verdicts", verdicts, ["passed", "failed", "passed"])


def test_rtf_kills_the_nodes_of_a_killed_fixture(scene: Scene) -> None:
    """The fixture should have ended them."""
    scene.start(ROVER, LONG)
    scene.disturb(lambda: kill([parent(*scene.processes("bin/roslaunch"))]))
    scene.collapsed("its process ended with signal 9 (SIGKILL)")


def test_the_guard_kills_the_nodes_of_a_killed_runner(scene: Scene) -> None:
    scene.start(ROVER, LONG)

    def kill_runner() -> None:
        expect("nodes before", len(scene.processes()) > 5, True)
        kill(children(scene.run.process.pid))

    scene.disturb(kill_runner)
    scene.finish(RUNNER_DIED)


def test_a_node_that_cannot_start_fails_the_set_up(scene: Scene) -> None:
    """At once, although roslaunch continues."""
    scene.start(broken(scene.directory))
    scene.finish(1)
    reason = scene.run.reason("fixture-broken")
    expect(f"`cannot launch node` in {reason!r}", "cannot launch node" in reason, True)
    expect("which one", "rover/rudder.py" in reason, True)


def test_a_node_that_crashes_at_the_end_makes_the_run_red(scene: Scene) -> None:
    """Although roslaunch ignores it."""
    scene.start(ending(scene.directory, "bad", ""))
    scene.finish(1)
    expect("verdicts", list(scene.run.verdicts().values()), ["passed"])
    (reason,) = scene.run.problems()
    for part in (
        "node /lidar was killed by SIGSEGV after SIGINT",
        "node /camera ended with exit code 3 after SIGINT",
    ):
        expect(f"`{part}` in {reason!r}", part in reason, True)
    expect("/arm, which ended well", "/arm" in reason, False)


def test_a_node_may_crash_at_the_end_if_that_is_allowed(scene: Scene) -> None:
    scene.start(ending(scene.directory, "good", MAY_DIE))
    scene.finish(0)


def test_only_the_bag_of_the_failed_test_is_attached(scene: Scene) -> None:
    scene.start(SLIPPING)
    scene.finish(1)
    expect("verdicts", list(scene.run.verdicts().values()), ["passed", "failed"])
    (bag,) = bags(scene)
    info = subprocess.run(["rosbag", "info", bag], capture_output=True, text=True, check=True)
    for topic in ("/rover/command", "/rover/speed", "/rover/distance"):
        expect(f"{topic} in the bag", topic in info.stdout, True)


def test_a_collapsed_test_has_its_bag(scene: Scene) -> None:
    """It shows the cause."""
    scene.start(SLIPPING, LONG)
    scene.kill("rover/odometer")
    scene.finish(1)
    expect("verdicts", list(scene.run.verdicts().values()), ["collapsed", "failed"])
    attached = sorted(bag.name for bag in bags(scene))
    expect("bags", attached, ["1-DistanceTest.bag", "1-RateTest.bag"])


def bags(scene: Scene) -> list[Path]:
    """The attached bags."""
    return list((scene.run.journal.parent / "attachments").rglob("*.bag"))


def test_a_probe_detects_a_silent_topic(scene: Scene) -> None:
    """A hung node is alive, but its topic is silent: the probe detects it."""
    scene.start(PROBES, LONG)
    scene.kill("wheel.py", signal.SIGSTOP)
    scene.finish(1)
    (reason,) = scene.run.reasons()
    expect(f"the topic in {reason!r}", reason.startswith("ROS topic /rover/speed: "), True)
    expect("verdicts", list(scene.run.verdicts().values()), ["collapsed", "passed"])
