"""Plays a bag of `ros2bag` into real nodes of ROS 2, and refuses what it cannot play."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from checkout import ROOT, exports, venv
from processes import MARK, commands, select
from recordings import messages, packages
from ros2_packages import shadow
from run import Run, expect, expect_in

pytestmark = pytest.mark.middleware("ros2")
SUITES = ROOT / "tests/fixtures/ros2bag"


@pytest.fixture(scope="module")
def bag(rtf: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A bag of all topics of the robot, whose library this process has, too."""
    directory = tmp_path_factory.mktemp("recorded")
    with pytest.MonkeyPatch.context() as patch:
        for name, value in exports("tools/middleware.sh", "ros2").items():
            patch.setenv(name, value + (os.environ["PATH"] if name == "PATH" else ""))
        patch.setenv("ROS_HOME", str(directory / "home"))
        patch.syspath_prepend(packages(venv("mcap")))
        run = Run(
            rtf,
            str(SUITES / "topics.xml"),
            directory / "results",
            "--set=options=--all --keep always",
        )
        expect("exit code", run.wait(), 0)
        (path,) = {
            run.journal.parent / event["attachment"]["path"]
            for event in run.events("attached")
            if "mcap" in str(event)
        }
        yield path.resolve().parent


@pytest.fixture(autouse=True)
def _nothing_is_left() -> Iterator[None]:
    yield
    mark = f"{MARK}={os.environ[MARK]}"
    left = select(lambda _, __, variables: mark in variables)
    expect("processes left", commands(left), [])


def play(rtf: str, recording: Path, directory: Path, options: str, *settings: str) -> Run:
    """Plays in place of the robot."""
    directory.mkdir(exist_ok=True)
    wanted = [
        f"--set={each}" for each in (f"recording={recording}", f"options={options}", *settings)
    ]
    return Run(rtf, str(SUITES / "replay.xml"), directory / "results", *wanted)


def metadata(file: Path) -> dict[str, str]:
    """What the recorder has noted about the test."""
    from mcap.reader import make_reader  # noqa: PLC0415 - the linters run without it

    with file.open("rb") as stream:
        found = [each for each in make_reader(stream).iter_metadata() if each.name == "rtf test"]
    (test,) = found
    return dict(test.metadata)


def number_in(data: bytes) -> int:
    """The value of a `std_msgs/msg/UInt64`."""
    return int.from_bytes(data[4:12], "little")


def test_messages_have_the_recorded_quality_of_service(rtf: str, tmp_path: Path, bag: Path) -> None:
    """What publishers keep is played, although it was published before the recorder started."""
    topics = "/map /scan /state /count=/number --clock"
    waits = "--subscriber left/hear=/number --subscriber left/hear=/scan"
    run = play(rtf, bag, tmp_path, f"{topics} {waits}", "hear=all")
    expect("exit code", run.wait(), 0)


def test_a_replay_begins_at_the_start_of_the_test_and_is_repeated(
    rtf: str, tmp_path: Path, bag: Path
) -> None:
    """The seconds before the test are recorded, and are not played."""
    (file,) = bag.glob("*.mcap")
    counted = [message for _, channel, message in messages(file) if channel.topic == "/count"]
    start = int(metadata(file)["start"])
    numbers = [number_in(message.data) for message in counted if message.log_time >= start]
    expect("there are earlier messages", len(numbers) < len(counted), True)
    options = "/count --end 0.2 --loop --rate 10 --subscriber /left/hear"
    run = play(rtf, bag, tmp_path, options, f"hear=repeated {numbers[0]}")
    expect("exit code", run.wait(), 0)


def test_a_subscriber_that_gets_nothing_is_named(rtf: str, tmp_path: Path, bag: Path) -> None:
    options = "/scan --subscriber /left/hear --timeout 3"
    run = play(rtf, bag, tmp_path, options, "hear=reliable")
    expect("exit code", run.wait(), 1)
    reason = "the node /left/hear does not receive /scan: it wants reliable messages"
    expect_in(reason, run.reasons()[0])


@pytest.mark.parametrize(
    ("defect", "reason"),
    [
        ("unknown", "its type lifecycle_msgs/msg/State is not installed"),
        ("changed", "it was recorded with another definition of lifecycle_msgs/msg/State"),
    ],
)
def test_a_type_that_is_not_the_recorded_one_is_refused(
    rtf: str, tmp_path: Path, bag: Path, defect: str, reason: str
) -> None:
    path = shadow(tmp_path / "shadow", is_known=defect == "changed")
    run = play(rtf, bag, tmp_path, "/state /cuont", f"path={path}")
    expect("exit code", run.wait(), 1)
    refused = run.reason("fixture-broken")
    expect_in(f"/state (ros2 lifecycle_msgs/msg/State) cannot be played: {reason}", refused)
    expect_in("has no topic /cuont (did you mean /count?)", refused)


def test_a_bag_without_definitions_is_refused(rtf: str, tmp_path: Path, bag: Path) -> None:
    from mcap.writer import Writer  # noqa: PLC0415

    (file,) = bag.glob("*.mcap")
    bare = tmp_path / "bare.mcap"
    with bare.open("wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2")
        channel = writer.register_channel("/count", "cdr", 0)
        for _, source, message in messages(file):
            if source.topic == "/count":
                writer.add_message(channel, message.log_time, message.data, message.log_time)
        writer.finish()
    run = play(rtf, bare, tmp_path, "/count")
    expect("exit code", run.wait(), 1)
    reason = "/count (cdr) cannot be played: the recording does not contain its type"
    expect_in(reason, run.reason("fixture-broken"))
