"""Records a node with a live source, and runs the same tests with the recording in its place.

All programs of the middleware are real.
"""

from __future__ import annotations

import os
import shlex
import signal
import statistics
from collections.abc import Iterator
from pathlib import Path

import processes
import pytest
from checkout import ROOT, call, exports, output_of, venv
from recordings import cut, packages, series
from run import Run, expect, expect_in

pytestmark = pytest.mark.first
SUITES = ROOT / "tests/fixtures/replay"
HERE = Path(__file__).parent
DEBIAN = "/usr/bin/python3"
"""Debian's rospy belongs to Debian's Python, which needs the library `mcap`, too."""

REPLAY = "live.replay"
MCAP = "-few.mcap"
"""What the test sampled."""
OWN = {
    "ros1": ("bag", ".bag"),
    "ros2": ("live.replay", "few_0.mcap"),
    "yarp": ("dump", ".tar.gz"),
}
"""The suite that plays the middleware's own format, and the ending of its files."""
VERDICTS = {"few": "passed", "none": "failed"}
# The node computes the same numbers from the same numbers.
VALUE_TOLERANCE = 1e-12
# Of the median message. At twice the rate, its difference is 0.75 s.
TIME_TOLERANCE_SECS = 0.25
# Of each played message; a busy node under test may be later with one answer.
PLAYED_TOLERANCE_SECS = 0.75


def library_for_debian() -> str:
    """The library `mcap` for Debian's Python."""
    return str(packages(venv("mcap", PATH=f"/usr/bin:{os.environ['PATH']}")))


class Scene:
    """A recording, and what is done with it."""

    def __init__(self, rtf: str, middleware: str, directory: Path) -> None:
        self.rtf, self.middleware, self.directory = rtf, middleware, directory
        self.is_ros = middleware == "ros1"
        self.answer = "/threshold/smooth:o" if middleware == "yarp" else "/smooth"
        self.own_suite, ending = OWN[middleware]
        self.live = self.start("live")
        self.finish(self.live, VERDICTS)
        self.mcap = attached(self.live, "few", MCAP)
        self.own = attached(self.live, "few", ending)
        self.recorded = series(self.mcap)

    def start(self, suite: str, recording: str = "", name: str = "", *options: str) -> Run:
        """Starts a run."""
        name = name or suite
        print(f"--- {self.middleware}: {name}", flush=True)
        file = SUITES / f"{self.middleware}-{suite}.xml"
        settings = [f"--set=recording={recording}"] if recording else []
        return Run(self.rtf, str(file), self.directory / f"{name}.run", *settings, *options)

    def finish(self, run: Run, verdicts: dict[str, str]) -> None:
        """Waits until the run ends."""
        expect("exit code", run.wait(), 1)
        expect("verdicts", run.verdicts(), verdicts)
        expect("collapses", list(run.events("fixture-collapsed")), [])

    def play_torn(self, suite: str, file: Path, complete: int) -> None:
        """All complete messages are played, and the report says that some are missing."""
        expect("some messages are complete", 0 < complete < 150, True)
        run = self.start(suite, str(file), file.name, f"--set=messages={complete}")
        run.wait()
        expect("verdicts", set(run.attempts()) <= {"passed", "failed"}, True)
        got = series(attached(run, "few", MCAP))
        expect("played messages", len(got["/level"]), complete)
        notes = [str(event) for event in run.events("message") if "is incomplete" in str(event)]
        expect("reports of a torn recording", len(notes), 1)
        expect("collapses", list(run.events("fixture-collapsed")), [])

    def expect_same(self, run: Run, *, with_times: bool = False) -> None:
        """The first test has the same inputs and outputs as with the live source."""
        got = series(attached(run, "few", MCAP))
        for name, expected in self.recorded.items():
            expect(f"number of {name}", len(got[name]), len(expected))
            pairs = list(zip(got[name], expected, strict=True))
            difference = max(abs(one[1] - other[1]) for one, other in pairs)
            expect(f"{name} within {VALUE_TOLERANCE}", difference <= VALUE_TOLERANCE, True)
            if with_times:
                drifts = [abs(one[0] - other[0]) for one, other in pairs]
                drift = statistics.median(drifts)
                worst = max(drifts)
                print(f"{name}: difference in time {drift:.4f} s, at most {worst:.4f} s")
                expect(f"times of {name}", drift <= TIME_TOLERANCE_SECS, True)
                if name == "/level":
                    expect("time of each played message", worst <= PLAYED_TOLERANCE_SECS, True)


@pytest.fixture(
    scope="module",
    params=[
        pytest.param("ros1", marks=pytest.mark.middleware("ros1")),
        pytest.param("ros2", marks=pytest.mark.middleware("ros2")),
        pytest.param("yarp", marks=pytest.mark.middleware("yarp")),
    ],
)
def scene(
    request: pytest.FixtureRequest, rtf: str, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Scene]:
    """A run with a live source. All tests of a middleware have its environment."""
    directory = tmp_path_factory.mktemp(request.param)
    with pytest.MonkeyPatch.context() as patch:
        for name, value in exports("tools/middleware.sh", request.param).items():
            patch.setenv(name, value + (os.environ["PATH"] if name == "PATH" else ""))
        patch.syspath_prepend(packages(venv("mcap")))
        if request.param == "ros1":
            patch.setenv("PYTHONPATH", library_for_debian())
        elif request.param == "yarp":
            patch.setenv("PATH", str(venv("mcap")), prepend=":")
        for name in ("ROS_HOME", "YARP_CONFIG_HOME"):
            patch.setenv(name, str(directory / "home"))
        for name in ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_IP", "YARP_NAMESPACE"):
            patch.delenv(name, raising=False)
        yield Scene(rtf, request.param, directory)


def test_a_live_source_is_recorded(scene: Scene) -> None:
    expect("recorded messages", len(scene.recorded["/level"]), 150)
    alarms = {value for _, value in scene.recorded["/alarms"]}
    expect("the limit of the tests divides the alarms", 0 < max(alarms) < 100, True)


def test_the_command_for_a_failed_test_repeats_the_failure(scene: Scene) -> None:
    """Without the live source."""
    lines = scene.live.output.read_text().splitlines()
    (line,) = [line for line in lines if line.startswith("    replay ")]
    words = shlex.split(line)[1:]
    expect("command", words[:2], ["rtf", "run"])
    endings = ["-none.mcap", *(["none_0.mcap"] if scene.middleware == "ros2" else [])]
    recordings = [f"recording={attached(scene.live, 'none', ending)}" for ending in endings]
    expect(f"one of the recordings: {words[-1]}", words[-1] in recordings, True)
    repeated = Run(scene.rtf, words[2], scene.directory / "command.run", *words[3:])
    scene.finish(repeated, {"none": "failed"})


def test_verdicts_and_outputs_are_the_same(scene: Scene) -> None:
    run = scene.start(REPLAY, str(scene.mcap))
    scene.finish(run, VERDICTS)
    scene.expect_same(run, with_times=True)
    provided = run.events("fixture-provided")
    (duration,) = {event["value"] for event in provided if event["name"] == "duration"}
    expect("provided duration", 2 < duration < 10, True)


def test_each_message_waits_for_the_answer_before(scene: Scene) -> None:
    """At a rate that no node can follow."""
    options = f"--rate 1000 --acknowledge /level={scene.answer}"
    run = scene.start(REPLAY, f"{scene.mcap} {options}", "lock-step")
    scene.finish(run, VERDICTS)
    scene.expect_same(run)


def test_a_recording_in_the_format_of_the_middleware_is_played(scene: Scene) -> None:
    run = scene.start(scene.own_suite, f"{scene.own} --rate 4", "its own format")
    scene.finish(run, VERDICTS)
    scene.expect_same(run)
    if scene.is_ros:
        file = scene.directory / "ros1.mcap"
        call(DEBIAN, HERE / "ros1_bags.py", "as_mcap", scene.own, file)
        run = scene.start(REPLAY, f"{file} --rate 4", "messages in MCAP")
        scene.finish(run, VERDICTS)
        scene.expect_same(run)


def test_a_start_after_the_end_is_refused(scene: Scene) -> None:
    run = scene.start(scene.own_suite, f"{scene.own} --start 99", "too late")
    expect("exit code", run.wait(), 1)
    expect_in("--start 99: the recording has only ", run.reason("fixture-broken"))


def test_a_suite_with_a_clock_follows_the_recording(scene: Scene) -> None:
    run = scene.start("clock", f"{scene.mcap} --rate 2 --clock")
    scene.finish(run, VERDICTS)
    scene.expect_same(run)


def test_the_recording_of_a_killed_recorder_is_played_as_far_as_it_goes(scene: Scene) -> None:
    scene.play_torn(REPLAY, *cut(scene.mcap, scene.directory / "torn.mcap"))
    if scene.is_ros:
        file = scene.directory / "torn.bag"
        library = os.environ["PYTHONPATH"]
        bags = HERE / "ros1_bags.py"
        complete = output_of(DEBIAN, bags, "cut_bag", scene.own, file, PYTHONPATH=library)
        scene.play_torn("bag", file, int(complete))


def test_a_killed_replay_is_a_collapse(scene: Scene) -> None:
    """If it dies before its end."""
    run = scene.start(REPLAY, f"{scene.mcap} --rate 0.5", "killed")

    def kill_replay() -> None:
        for pid in processes.running("process.py"):
            os.kill(pid, signal.SIGKILL)

    run.disturb(kill_replay)
    expect("exit code", run.wait(), 1)
    expect("reasons", set(run.reasons()), {"the replay was killed by SIGKILL"})
    expect("first verdict", run.attempts()[0], "collapsed")


def test_topics_that_cannot_be_played_are_named(scene: Scene) -> None:
    """At once, before any test."""
    run = scene.start(REPLAY, f"{scene.mcap} /smooth=/level /no-such", "refused")
    expect("exit code", run.wait(), 1)
    expect_in("has no topic /no-such; it has /", run.reason("fixture-broken"))
    expect_in("two topics are played as /level", run.reason("fixture-broken"))


def test_a_missing_subscriber_is_named(scene: Scene) -> None:
    run = scene.start(REPLAY, f"{scene.mcap} --timeout 1 --subscriber /nobody", "nobody")
    expect("exit code", run.wait(), 1)
    expect_in("not within 1 s: ", run.reasons()[0])
    expect_in("/nobody", run.reasons()[0])


@pytest.mark.middleware("ros1")
def test_a_subscriber_that_has_ended_is_missing() -> None:
    path = [library_for_debian(), str(ROOT / "tests/harness"), str(ROOT / "fixtures")]
    call(DEBIAN, HERE / "ended_subscriber.py", PYTHONPATH=":".join(path))


def attached(run: Run, test: str, ending: str) -> Path:
    """The file of the last attempt of a test with this ending."""
    files = [
        run.journal.parent / event["attachment"]["path"]
        for event in run.events("attached")
        if run.name(event) == test
    ]
    found = [file for file in files if file.name.endswith(ending)]
    expect(f"a {ending} of {test}", len(found) > 0, True)
    path: Path = found[-1].resolve()
    return path
