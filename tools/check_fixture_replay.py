#!/usr/bin/env python3
"""Records a node with a live source, and runs the same tests with the recording in its place.

    check_fixture_replay.py RTF SUITES MIDDLEWARE

MIDDLEWARE is `ros1` or `yarp`; all its programs are real. Needs a Python with the library
`mcap`, also in the Python of the suites.
"""

from __future__ import annotations

import os
import shlex
import signal
import statistics
import sys
import tempfile
from pathlib import Path

import processes
from recordings import as_mcap, cut, cut_bag, series
from run import Run, expect, expect_in

REPLAY = "live.replay"
VERDICTS = {"few": "passed", "none": "failed"}
# The node computes the same numbers from the same numbers.
VALUE_TOLERANCE = 1e-12
# Of the median message. At twice the rate, its difference is 0.75 s.
TIME_TOLERANCE_SECS = 0.25
# Of each played message; a busy node under test may be later with one answer.
PLAYED_TOLERANCE_SECS = 0.75


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
        self.command_for_failed_test(run)

    def command_for_failed_test(self, run: Run) -> None:
        """The command that the report prints repeats the failure without the live source."""
        lines = run.output.read_text().splitlines()
        (line,) = [line for line in lines if line.startswith("    replay ")]
        words = shlex.split(line)[1:]
        expect("command", words[:2], ["rtf", "run"])
        expect("its recording", words[-1], f"recording={attached(run, 'none', '.mcap')}")
        print(f"--- {self.middleware}: {' '.join(words)}", flush=True)
        repeated = Run(str(self.rtf), words[2], self.directory / "command.run", *words[3:])
        self.finish(repeated, {"none": "failed"})

    def same_verdicts(self) -> None:
        """With the recording in place of the source, verdicts and outputs are the same."""
        run = self.start(REPLAY, str(self.mcap))
        self.finish(run, VERDICTS)
        self.expect_same(run, with_times=True)
        provided = run.events("fixture-provided")
        (duration,) = {event["value"] for event in provided if event["name"] == "duration"}
        expect("provided duration", 2 < duration < 10, True)

    def in_lock_step(self) -> None:
        """At a rate that no node can follow, each message waits for the answer before."""
        options = f"--rate 1000 --acknowledge /level={self.answer}"
        run = self.start(REPLAY, f"{self.mcap} {options}", "lock-step")
        self.finish(run, VERDICTS)
        self.expect_same(run)

    def own_format(self) -> None:
        """The middleware's own recording is played, too, and only the requested part of it."""
        suite = "bag" if self.middleware == "ros1" else "dump"
        run = self.start(suite, f"{self.own} --rate 4")
        self.finish(run, VERDICTS)
        self.expect_same(run)
        if self.middleware == "ros1":
            file = as_mcap(self.own, self.directory / "ros1.mcap")
            run = self.start(REPLAY, f"{file} --rate 4", "messages in MCAP")
            self.finish(run, VERDICTS)
            self.expect_same(run)
        run = self.start(suite, f"{self.own} --start 99", "too late")
        expect("exit code", run.wait(), 1)
        expect_in("--start 99: the recording has only ", run.reason("fixture-broken"))

    def in_recorded_time(self) -> None:
        """A suite with `clock` follows the recording."""
        run = self.start("clock", f"{self.mcap} --rate 2 --clock")
        self.finish(run, VERDICTS)
        self.expect_same(run)

    def torn(self) -> None:
        """What a killed recorder has left is played as far as it goes."""
        self.play_torn(REPLAY, *cut(self.mcap, self.directory / "torn.mcap"))
        if self.middleware == "ros1":
            self.play_torn("bag", *cut_bag(self.own, self.directory / "torn.bag"))

    def play_torn(self, suite: str, file: Path, complete: int) -> None:
        """All complete messages are played, and the report says that some are missing."""
        expect("some messages are complete", 0 < complete < 150, True)
        run = self.start(suite, str(file), file.name, f"--set=messages={complete}")
        run.wait()
        expect("verdicts", set(run.attempts()) <= {"passed", "failed"}, True)
        got = series(attached(run, "few", ".mcap"))
        expect("played messages", len(got["/level"]), complete)
        notes = [str(event) for event in run.events("message") if "is incomplete" in str(event)]
        expect("reports of a torn recording", len(notes), 1)
        expect("collapses", list(run.events("fixture-collapsed")), [])

    def killed(self) -> None:
        """A replay that dies before its end is a collapse."""
        run = self.start(REPLAY, f"{self.mcap} --rate 0.5", "killed")

        def kill_replay() -> None:
            for pid in processes.running("process.py"):
                os.kill(pid, signal.SIGKILL)

        run.disturb(kill_replay)
        expect("exit code", run.wait(), 1)
        expect("reasons", set(run.reasons()), {"the replay was killed by SIGKILL"})
        expect("first verdict", run.attempts()[0], "collapsed")

    def refused(self) -> None:
        """Everything that cannot be played is named at once, before any test."""
        run = self.start(REPLAY, f"{self.mcap} /smooth=/level /no-such", "refused")
        expect("exit code", run.wait(), 1)
        expect_in("has no topic /no-such; it has /", run.reason("fixture-broken"))
        expect_in("two topics are played as /level", run.reason("fixture-broken"))
        run = self.start(REPLAY, f"{self.mcap} --timeout 1 --subscriber /nobody", "nobody")
        expect("exit code", run.wait(), 1)
        expect_in("not within 1 s: ", run.reasons()[0])
        expect_in("/nobody", run.reasons()[0])

    def start(self, suite: str, recording: str = "", name: str = "", *options: str) -> Run:
        """Starts a run."""
        name = name or suite
        print(f"--- {self.middleware}: {name}", flush=True)
        file = self.suites / f"{self.middleware}-{suite}.xml"
        settings = [f"--set=recording={recording}"] if recording else []
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
                drifts = [abs(one[0] - other[0]) for one, other in pairs]
                drift = statistics.median(drifts)
                worst = max(drifts)
                print(f"{name}: difference in time {drift:.4f} s, at most {worst:.4f} s")
                expect(f"times of {name}", drift <= TIME_TOLERANCE_SECS, True)
                if name == "/level":
                    expect("time of each played message", worst <= PLAYED_TOLERANCE_SECS, True)


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


if __name__ == "__main__":
    sys.exit(main())
