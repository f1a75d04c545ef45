#!/usr/bin/env python3
"""Records a node with a live source, and runs the same tests with the recording in its place.

    check_fixture_replay.py RTF SUITES MIDDLEWARE

MIDDLEWARE is `ros1` or `yarp`; all its programs are real. Needs a Python with the library
`mcap`, also in the Python of the suites.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import processes
from run import Run, expect, expect_in

VERDICTS = {"few": "passed", "none": "failed"}
# The node computes the same numbers from the same numbers.
VALUE_TOLERANCE = 1e-12
# Of the times between two messages; the machine is busy.
TIME_TOLERANCE_SECS = 0.75

Series = dict[str, list[tuple[float, float]]]


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, suites = (Path(argument).resolve() for argument in sys.argv[1:3])
    with tempfile.TemporaryDirectory() as name:
        os.environ["YARP_CONFIG_HOME"] = os.environ["ROS_HOME"] = f"{name}/home"
        for variable in ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_IP", "YARP_NAMESPACE"):
            os.environ.pop(variable, None)
        scene = Scene(rtf, suites, Path(name), sys.argv[3])
        scene.record()
        scene.same_verdicts()
        scene.in_lock_step()
        scene.own_format()
        scene.in_recorded_time()
        scene.torn()
        scene.killed()
        scene.refused()
    return 0


class Scene:
    """A recording, and what is done with it."""

    def __init__(self, rtf: Path, suites: Path, directory: Path, middleware: str) -> None:
        self.rtf, self.suites, self.directory = rtf, suites, directory
        self.middleware = middleware
        self.answer = "/smooth" if middleware == "ros1" else "/threshold/smooth:o"

    def record(self) -> None:
        """The first run has a live source."""
        run = self.start("live")
        self.finish(run, VERDICTS)
        self.mcap = attached(run, "few", ".mcap")
        self.own = attached(run, "few", ".bag" if self.middleware == "ros1" else ".tar.gz")
        self.recorded = series(self.mcap)
        expect("recorded messages", len(self.recorded["/level"]), 150)
        alarms = {value for _, value in self.recorded["/alarms"]}
        expect("the limit of the tests divides the alarms", 0 < max(alarms) < 100, True)

    def same_verdicts(self) -> None:
        """With the recording in place of the source, verdicts and outputs are the same."""
        run = self.start("replay", f"{self.mcap} /level --to {self.middleware}")
        self.finish(run, VERDICTS)
        self.expect_same(run, with_times=True)
        (duration,) = {
            event["value"]
            for event in run.events("fixture-provided")
            if event["name"] == "duration"
        }
        expect("provided duration", 2 < duration < 10, True)

    def in_lock_step(self) -> None:
        """At a rate that no node can follow, each message waits for the answer before."""
        play = f"{self.mcap} /level --to {self.middleware} --rate 1000"
        run = self.start("replay", f"{play} --acknowledge /level={self.answer}", "lock-step")
        self.finish(run, VERDICTS)
        self.expect_same(run)

    def own_format(self) -> None:
        """The middleware's own recording is played, too, and only the requested part of it."""
        suite = "bag" if self.middleware == "ros1" else "dump"
        run = self.start(suite, f"{self.own} /level --rate 4")
        self.finish(run, VERDICTS)
        self.expect_same(run)
        run = self.start(suite, f"{self.own} /level --start 99", "too late")
        self.expect_broken(run, "--start 99: the recording has only ")

    def in_recorded_time(self) -> None:
        """A suite with `clock` follows the recording."""
        play = f"{self.mcap} /level --to {self.middleware} --rate 2 --clock"
        run = self.start("clock", play)
        self.finish(run, VERDICTS)
        self.expect_same(run)

    def torn(self) -> None:
        """What a killed recorder has left is played as far as it goes."""
        file, complete = cut(self.mcap, self.directory / "torn.mcap")
        self.play_torn(f"{file} /level --to {self.middleware}", "replay", complete)
        if self.middleware == "ros1":
            file, complete = cut_bag(self.own, self.directory / "torn.bag")
            self.play_torn(f"{file} /level", "bag", complete)

    def play_torn(self, play: str, suite: str, complete: int) -> None:
        """All complete messages are played, and the report says that some are missing."""
        expect("complete messages", 0 < complete < 150, True)
        run = self.start(suite, play, f"torn {suite}", f"--set=messages={complete}")
        run.wait()
        expect("attempts", "error" in run.attempts() or "collapsed" in run.attempts(), False)
        got = series(attached(run, "few", ".mcap"))
        expect("played messages", len(got["/level"]), complete)
        notes = [str(event) for event in run.events("message") if "is incomplete" in str(event)]
        expect("reports of a torn recording", len(notes), 1)
        expect("collapses", list(run.events("fixture-collapsed")), [])

    def killed(self) -> None:
        """A replay that dies before its end is a collapse."""
        play = f"{self.mcap} /level --to {self.middleware} --rate 0.5"
        run = self.start("replay", play, "killed")

        def kill_replay() -> None:
            for pid in processes.running("process.py"):
                os.kill(pid, signal.SIGKILL)

        run.disturb(kill_replay)
        expect("exit code", run.wait(), 1)
        expect("reasons", set(run.reasons()), {"the replay was killed by SIGKILL"})
        expect("first verdict", run.attempts()[0], "collapsed")

    def refused(self) -> None:
        """Everything that cannot be played is named at once, before any test."""
        play = f"{self.mcap} /level=/a /smooth=/a /no-such --to {self.middleware}"
        run = self.start("replay", play, "refused")
        self.expect_broken(run, "has no topic /no-such; it has /")
        self.expect_broken(run, "two topics are played as /a")
        play = f"{self.mcap} /level --to {self.middleware} --timeout 1 --subscriber /nobody"
        run = self.start("replay", play, "nobody")
        expect("exit code", run.wait(), 1)
        expect_in("/nobody", run.reasons()[0])
        expect_in("not within 1 s: ", run.reasons()[0])

    def start(self, suite: str, play: str = "", name: str = "", *options: str) -> Run:
        """Starts a run."""
        name = name or suite
        print(f"--- {self.middleware}: {name}", flush=True)
        file = self.suites / f"{self.middleware}-{suite}.xml"
        settings = [f"--set=play={play}"] if play else []
        return Run(str(self.rtf), str(file), self.directory / f"{name}.run", *settings, *options)

    def finish(self, run: Run, verdicts: dict[str, str]) -> None:
        """Waits until the run ends."""
        expect("exit code", run.wait(), 1)
        expect("verdicts", run.verdicts(), verdicts)
        expect("collapses", list(run.events("fixture-collapsed")), [])

    def expect_same(self, run: Run, *, with_times: bool = False) -> None:
        """The first test has the same inputs and outputs as with the live source."""
        got = series(attached(run, "few", ".mcap"))
        for name, expected in self.recorded.items():
            expect(f"number of {name}", len(got[name]), len(expected))
            pairs = list(zip(got[name], expected, strict=True))
            difference = max(abs(one[1] - other[1]) for one, other in pairs)
            expect(f"{name} within {VALUE_TOLERANCE}", difference <= VALUE_TOLERANCE, True)
            if with_times:
                drift = max(abs(one[0] - other[0]) for one, other in pairs)
                print(f"{name}: largest difference in time {drift * 1000:.1f} ms")
                expect(f"times of {name}", drift <= TIME_TOLERANCE_SECS, True)

    def expect_broken(self, run: Run, reason: str) -> None:
        """The set-up fails with this reason."""
        expect("exit code", run.wait(), 1)
        expect_in(reason, run.reason("fixture-broken"))


def attached(run: Run, test: str, ending: str) -> Path:
    """The file of the last attempt of a test with this ending."""
    files = [
        run.journal.parent / event["attachment"]["path"]
        for event in run.events("attached")
        if run.name(event) == test
    ]
    found = [file for file in files if file.name.endswith(ending)]
    expect(f"a {ending} of {test}", len(found) > 0, True)
    return found[-1].resolve()


def messages(file: Path) -> Iterator[Any]:
    """The schemas, channels and messages of a recording."""
    from mcap.reader import make_reader  # noqa: PLC0415 - the linters run without it

    with file.open("rb") as stream:
        yield from make_reader(stream).iter_messages()


def series(file: Path) -> Series:
    """The times since the first message of a channel, and the values."""
    found: Series = {}
    for _, channel, message in messages(file):
        if channel.topic != "/log":
            value = json.loads(message.data)["value"]
            found.setdefault(channel.topic, []).append((message.log_time * 1e-9, value))
    return {
        name: [(at - points[0][0], value) for at, value in points] for name, points in found.items()
    }


def cut(file: Path, torn: Path) -> tuple[Path, int]:
    """Write a recording with many chunks and cut it off; the number of complete messages."""
    from mcap.reader import NonSeekingReader  # noqa: PLC0415
    from mcap.writer import Writer  # noqa: PLC0415

    with torn.open("wb") as stream:
        writer = Writer(stream, chunk_size=1024)
        writer.start()
        schema = writer.register_schema("measurement", "jsonschema", b"{}")
        level = writer.register_channel("/level", "json", schema)
        for _, channel, message in messages(file):
            if channel.topic == "/level":
                writer.add_message(level, message.log_time, message.data, message.log_time)
        writer.finish()
    os.truncate(torn, torn.stat().st_size // 2)
    complete = 0
    with torn.open("rb") as stream, contextlib.suppress(Exception):
        for _ in NonSeekingReader(stream).iter_messages(log_time_order=False):
            complete += 1
    return torn, complete


def cut_bag(file: Path, torn: Path) -> tuple[Path, int]:
    """Write a bag with many chunks and cut it off; the number of messages ROS can restore."""
    import rosbag  # noqa: PLC0415 - only with ROS

    with rosbag.Bag(str(file)) as bag, rosbag.Bag(str(torn), "w", chunk_threshold=512) as copy:
        for topic, message, at in bag.read_messages(topics=["/level"]):
            copy.write(topic, message, at)
    os.truncate(torn, torn.stat().st_size // 2)
    restored = torn.with_name("restored.bag")
    restored.write_bytes(torn.read_bytes())
    subprocess.run(["rosbag", "reindex", "-q", str(restored)], check=True)
    with rosbag.Bag(str(restored)) as bag:
        return torn, int(bag.get_message_count())


if __name__ == "__main__":
    sys.exit(main())
