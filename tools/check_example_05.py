#!/usr/bin/env python3
"""Runs example 05 as a user does, and while parts of ROS are killed.

    check_example_05.py RTF EXAMPLE PROBES

roscore, roslaunch and nodes get a SIGKILL during a test. Some runs are parallel, with
separate masters. No packet may leave the machine.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import network
from pages import run_fixture_page
from processes import children, commands, kill, parent, select
from run import Event, Run, expect

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


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, example, probes = (Path(argument).resolve() for argument in sys.argv[1:])
    rover, slipping = example / "rover.xml", example / "slipping.xml"
    network.move_in()
    with tempfile.TemporaryDirectory() as directory, network.quiet("lesson 5"):
        home = Path(directory) / "home"
        os.environ["ROS_HOME"] = str(home)
        for name in ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_IP", "ROS_LOG_DIR"):
            os.environ.pop(name, None)

        def scene(check: Check, suite: Path, options: list[str]) -> None:
            Scene(rtf, suite, Path(directory) / f"run-{check.__name__}", options).play(check)

        scenes: list[tuple[Check, Path, list[str]]] = [
            (undisturbed, rover, []),
            (respawned, rover, [LONG]),
            (not_to_be_respawned, rover, [LONG, "--set=respawn="]),
            (required, rover, [LONG]),
            (master_killed, rover, [LONG]),
            (roslaunch_killed, rover, [LONG]),
            (fixture_killed, rover, [LONG]),
            (frozen, rover, []),
            (runner_killed, rover, [LONG]),
            (not_launched, broken(Path(directory)), []),
            (ended_badly, ending(Path(directory), "bad", ""), []),
            (may_end_badly, ending(Path(directory), "good", MAY_DIE), []),
            (bag_kept, slipping, []),
            (bag_of_collapse, slipping, [LONG]),
            (silent, probes, [LONG]),
        ]
        with ThreadPoolExecutor(max_workers=3) as pool:
            pages = [
                pool.submit(run_fixture_page, str(rtf), "roscore", Path(directory) / "roscore")
            ]
            for page in ("roslaunch", "rosbag"):
                place = Path(directory) / page
                pages.append(pool.submit(run_fixture_page, str(rtf), page, place, example))
            for played in [pool.submit(scene, *each) for each in scenes]:
                played.result()
            for page_run in pages:
                page_run.result()
        expect("logs in ROS_HOME", list(home.rglob("*.log*")), [])
    return 0


class Scene:
    """A run of rtf with a private ROS master."""

    def __init__(self, rtf: Path, suite: Path, directory: Path, options: list[str]) -> None:
        self.run = Run(str(rtf), str(suite), directory, *options)
        self.directory = directory

    def play(self, check: Check) -> None:
        """Checks the run, and that no ROS process is left."""
        self.title = check.__name__
        try:
            check(self)
        finally:
            self.run.stop()
        self.expect("processes left", commands(self.processes()), [])

    def expect(self, what: str, got: object, expected: object) -> None:
        """Exits with a message if a value is not as expected."""
        expect(f"{self.title}: {what}", got, expected)

    def kill(self, word: str, number: signal.Signals = signal.SIGKILL) -> None:
        """Sends a signal to a ROS process while the victim runs."""
        self.disturb(lambda: kill(self.processes(word), number))

    def disturb(self, disturbance: Callable[[], None]) -> None:
        """Disturbs the run while the victim runs."""
        self.run.disturb(disturbance, VICTIM)

    def finish(self, code: int) -> None:
        """Waits until the run ends."""
        self.expect("exit code", self.run.wait(), code)

    def processes(self, word: str = "") -> list[int]:
        """The processes that use this run's master, or those whose command lines contain a word."""
        master = self.master()
        return select(lambda _, words, variables: master in variables and word in " ".join(words))

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
        self.expect("reason", self.run.reasons(), [reason])
        verdicts = self.run.verdicts()
        self.expect(f"verdict of {VICTIM}", verdicts.pop(VICTIM), "collapsed")
        self.expect("other verdicts", set(verdicts.values()), {"passed"})


Check = Callable[[Scene], None]


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


def undisturbed(scene: Scene) -> None:
    """All tests pass."""
    scene.finish(0)
    scene.expect("verdicts", list(scene.run.verdicts().values()), ["passed"] * 3)


def respawned(scene: Scene) -> None:
    """The wheel dies and roslaunch restarts it: this is reported, and nothing collapses."""
    scene.kill("wheel.py")
    scene.finish(0)
    sent = " ".join(str(event["message"]["text"]) for event in scene.events("message"))
    scene.expect("reported", "node /rover/wheel was killed by SIGKILL (exit code -9)" in sent, True)
    scene.expect("reported", "node /rover/wheel was started again by roslaunch" in sent, True)
    scene.expect("collapses", scene.run.reasons(), [])


def not_to_be_respawned(scene: Scene) -> None:
    """Without `--allow-respawn`, the same is a collapse."""
    scene.kill("wheel.py")
    scene.collapsed(
        "node /rover/wheel was killed by SIGKILL (exit code -9) "
        "(`--allow-respawn` tolerates that of respawned nodes)"
    )


def required(scene: Scene) -> None:
    """A required node dies, and roslaunch exits with 0: this is a collapse."""
    scene.kill("rover/odometer")
    scene.collapsed("node /rover/odometer was killed by SIGKILL (exit code -9)")
    scene.expect("starts", len(scene.events("fixture-ready")), 3)
    # The logs of both starts are in the results.
    logs = scene.run.journal.parent / "logs" / "rover.ros"
    starts = {path.parent for path in logs.glob("*/rover-wheel-*.log")}
    scene.expect("directories with the logs of nodes", len(starts), 2)


def master_killed(scene: Scene) -> None:
    """The death of the master is detected, and the fixtures that depend on it are restarted."""
    scene.kill("rosmaster")
    scene.collapsed("the master was killed by SIGKILL (exit code -9)")
    scene.expect("starts", len(scene.events("fixture-ready")), 4)


def roslaunch_killed(scene: Scene) -> None:
    """Its nodes are separate sessions and survive it; rtf kills them."""
    scene.kill("bin/roslaunch")
    scene.collapsed("roslaunch was killed by SIGKILL")


def frozen(scene: Scene) -> None:
    """A hung node has a process and is in the master's list: `check` before a test detects it."""
    scene.kill("rover/odometer", signal.SIGSTOP)
    scene.finish(1)
    (reason,) = scene.run.reasons()
    scene.expect(f"the node in {reason!r}", "node /rover/odometer: nobody answers" in reason, True)
    verdicts = list(scene.run.verdicts().values())
    scene.expect("verdicts", verdicts, ["passed", "failed", "passed"])


def fixture_killed(scene: Scene) -> None:
    """The plug-in is killed, which should have ended the nodes: rtf kills them."""
    scene.disturb(lambda: kill([parent(*scene.processes("bin/roslaunch"))]))
    scene.collapsed("its process ended with signal 9 (SIGKILL)")


def runner_killed(scene: Scene) -> None:
    """The guard kills everything, including the nodes."""

    def kill_runner() -> None:
        scene.expect("nodes before", len(scene.processes()) > 5, True)
        kill(children(scene.run.process.pid))

    scene.disturb(kill_runner)
    scene.finish(RUNNER_DIED)


def not_launched(scene: Scene) -> None:
    """A node that cannot start fails the set-up at once, although roslaunch continues."""
    scene.finish(1)
    reason = scene.run.reason("fixture-broken")
    scene.expect(f"`cannot launch node` in {reason!r}", "cannot launch node" in reason, True)
    scene.expect("which one", "rover/rudder.py" in reason, True)


def ended_badly(scene: Scene) -> None:
    """A node that crashes while it is stopped makes the run red, although roslaunch ignores it."""
    scene.finish(1)
    scene.expect("verdicts", list(scene.run.verdicts().values()), ["passed"])
    (reason,) = scene.run.problems()
    for part in (
        "node /lidar was killed by SIGSEGV after SIGINT",
        "node /camera ended with exit code 3 after SIGINT",
    ):
        scene.expect(f"`{part}` in {reason!r}", part in reason, True)
    scene.expect("/arm, which ended well", "/arm" in reason, False)


def may_end_badly(scene: Scene) -> None:
    """`--may-die` allows it."""
    scene.finish(0)


def bag_kept(scene: Scene) -> None:
    """Only the bag of the failed test is attached."""
    scene.finish(1)
    scene.expect("verdicts", list(scene.run.verdicts().values()), ["passed", "failed"])
    (bag,) = bags(scene)
    info = subprocess.run(["rosbag", "info", bag], capture_output=True, text=True, check=True)
    for topic in ("/rover/command", "/rover/speed", "/rover/distance"):
        scene.expect(f"{topic} in the bag", topic in info.stdout, True)


def bag_of_collapse(scene: Scene) -> None:
    """A collapsed test has its bag, too, which shows the cause."""
    scene.kill("rover/odometer")
    scene.finish(1)
    scene.expect("verdicts", list(scene.run.verdicts().values()), ["collapsed", "failed"])
    attached = sorted(bag.name for bag in bags(scene))
    scene.expect("bags", attached, ["1-DistanceTest.bag", "1-RateTest.bag"])


def bags(scene: Scene) -> list[Path]:
    """The attached bags."""
    return list((scene.run.journal.parent / "attachments").rglob("*.bag"))


def silent(scene: Scene) -> None:
    """A hung node is alive, but its topic is silent: the probe detects it."""
    scene.kill("wheel.py", signal.SIGSTOP)
    scene.finish(1)
    (reason,) = scene.run.reasons()
    scene.expect(f"the topic in {reason!r}", reason.startswith("ROS topic /rover/speed: "), True)
    scene.expect("verdicts", list(scene.run.verdicts().values()), ["collapsed", "passed"])


if __name__ == "__main__":
    sys.exit(main())
