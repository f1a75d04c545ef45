"""Records real nodes of ROS 2 with the fixture `ros2bag`; the library `rosbags` reads the bags."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from checkout import ROOT, output_of, venv
from pages import run_fixture_page
from processes import MARK, commands, kill, running, select
from ros2_packages import shadow
from run import Run, expect, expect_in

pytestmark = [pytest.mark.middleware("ros2"), pytest.mark.usefixtures("home")]
SUITES = ROOT / "tests/fixtures/ros2bag"
READER = ROOT / "tests/middleware/ros2_bags.py"
ALL = {"/arm/left/colour", "/clock", "/count", "/map", "/scan", "/state"}


@pytest.fixture(autouse=True)
def _nothing_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    temporary = tmp_path / "tmp"
    temporary.mkdir()
    monkeypatch.setenv("TMPDIR", str(temporary))
    yield
    expect("directories left", list(temporary.glob("rtf-ros2bag-*")), [])
    mark = f"{MARK}={os.environ[MARK]}"
    left = select(lambda _, __, variables: mark in variables)
    expect("processes left", commands(left), [])


def test_a_test_that_did_not_pass_has_a_complete_bag(rtf: str, tmp_path: Path) -> None:
    run = start(rtf, tmp_path, "suite", "--all")
    expect("exit code", run.wait(), 1)
    expect("collapses", run.reasons(), [])
    found = bags(run)
    expect("bags", [bag.name for bag in found], ["1-bad", "1-bad.r1.a2"])
    for bag in found:
        topics = content(bag)["topics"]
        expect("topics", topics.keys() >= ALL | {"/marks", "/twice"}, True)
        # The end of the test before is in the seconds before the start.
        expect("the whole test", topics["/marks"]["values"][-2:], ["begin", "end"])
        begin = topics["/marks"]["times"][-2]
        complete(topics["/count"], before=begin)
        complete(topics["/clock"], before=begin, step=5_000_000)
        # A publisher with another quality of service came later.
        expect("both publishers", set(topics["/twice"]["values"]), {1, 2})
        # It was published before the recorder started.
        expect("what publishers keep", topics["/map"]["values"], ["walls"])
        expect("colour", topics["/arm/left/colour"]["values"], [0.5])
        described(topics)


def complete(topic: dict[str, Any], *, before: int, step: int = 1) -> None:
    """A counter has no gap, and begins before the test."""
    values = topic["values"]
    expected = list(range(values[0], values[0] + step * len(values), step))
    expect(f"{len(values)} messages without a gap", values == expected, True)
    expect("its number in the index", topic["count"], len(values))
    expect("messages before the test", topic["times"][0] < before, True)
    expect("messages of the test", topic["times"][-1] > before, True)


def described(topics: dict[str, Any]) -> None:
    """Each topic has its type, its definition, and what its publisher offered."""
    scan = topics["/scan"]
    expect("type", scan["type"], "std_msgs/msg/UInt8MultiArray")
    for name in ("MSG: std_msgs/MultiArrayLayout", "MSG: std_msgs/MultiArrayDimension"):
        expect_in(name, scan["definition"])
    expect("lossy", (scan["reliability"], scan["durability"]), ("BEST_EFFORT", "VOLATILE"))
    kept = topics["/map"]
    expect("kept", (kept["reliability"], kept["durability"]), ("RELIABLE", "TRANSIENT_LOCAL"))
    expect("values of the scan", scan["values"][0], list(range(100)))
    expect("state", set(topics["/state"]["values"]), {"active"})


def test_the_file_alone_is_a_bag_too(rtf: str, tmp_path: Path) -> None:
    """As Foxglove opens it, and `mcapplay`."""
    run = start(rtf, tmp_path, "topics", "/count --compress zstd --keep always")
    expect("exit code", run.wait(), 0)
    (bag,) = bags(run)
    (file,) = bag.glob("*.mcap")
    alone, whole = content(file), content(bag)
    expect("count", alone["count"], whole["count"])
    expect("values", alone["topics"]["/count"]["values"], whole["topics"]["/count"]["values"])


@pytest.mark.parametrize(
    ("options", "topics"),
    [
        ("count /map", {"/count", "/map"}),
        ("--regex ^/arm/", {"/arm/left/colour"}),
        ("--type std_msgs/String --type std_msgs/msg/UInt64", {"/count", "/map"}),
        ("--all --exclude a|lo|/parameter /count", {"/count"}),
    ],
)
def test_topics_are_selected(rtf: str, tmp_path: Path, options: str, topics: set[str]) -> None:
    run = start(rtf, tmp_path, "topics", f"{options} --keep always")
    expect("exit code", run.wait(), 0)
    (bag,) = bags(run)
    expect("topics", set(content(bag)["topics"]), topics)


def test_a_topic_that_no_node_publishes_is_reported(rtf: str, tmp_path: Path) -> None:
    """Also if the test passes, and with what may be meant."""
    run = start(rtf, tmp_path, "topics", "/cuont --keep always")
    expect("exit code", run.wait(), 0)
    expect_in("no node has published /cuont; did you mean /count?", notes(run))
    expect_in("wait is not attached: no message was recorded", notes(run))
    expect("bags", bags(run), [])


def test_a_recording_has_a_limit(rtf: str, tmp_path: Path) -> None:
    """Its beginning is kept."""
    run = start(rtf, tmp_path, "topics", "/count --keep always --limit 20k")
    expect("exit code", run.wait(), 0)
    (bag,) = bags(run)
    size = sum(file.stat().st_size for file in bag.iterdir())
    expect(f"{size} bytes", size <= 20_000, True)
    values = content(bag)["topics"]["/count"]["values"]
    expect("without a gap", values, list(range(values[0], values[0] + len(values))))
    expect_in("it ends before the test: ", notes(run))
    expect_in("messages would exceed --limit 0.02M", notes(run))


def test_too_many_topics_are_refused(rtf: str, tmp_path: Path) -> None:
    topics = "topics=/a /b /c"
    run = start(rtf, tmp_path, "topics", "--regex ^/.{1,5}$ --max-topics 3", topics)
    expect("exit code", run.wait(), 1)
    expect_in("4 topics match, such as /a: more than --max-topics 3", run.reason("fixture-broken"))


@pytest.mark.parametrize(
    ("defect", "reason"),
    [
        ("unknown", "its type lifecycle_msgs/msg/State is not installed"),
        ("changed", "its publisher has another definition of lifecycle_msgs/msg/State"),
    ],
)
def test_a_type_that_is_not_the_installed_one_is_refused(
    rtf: str, tmp_path: Path, defect: str, reason: str
) -> None:
    """A topic that was not named is left out, with a report."""
    path = f"path={shadow(tmp_path / 'shadow', is_known=defect == 'changed')}"
    run = start(rtf, tmp_path / "named", "topics", "/state", path)
    expect("exit code", run.wait(), 1)
    expect_in(f"/state cannot be recorded: {reason}", run.reason("fixture-broken"))
    run = start(rtf, tmp_path / "all", "topics", "--all --keep always", path)
    expect("exit code", run.wait(), 0)
    expect_in(f"/state is left out: {reason}", notes(run))
    (bag,) = bags(run)
    expect("others are recorded", ALL - set(content(bag)["topics"]), {"/state"})


def test_a_full_disk_is_a_collapse(
    rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    small = tmp_path / "small"
    small.mkdir()
    program = tmp_path / "rtf"
    options = "--mount" if os.geteuid() == 0 else "--mount --map-root-user"
    mount = f"mount -t tmpfs -o size=256k none {small}"
    program.write_text(
        f'#!/bin/sh\nexec unshare {options} sh -c \'{mount} && exec "$@"\' {rtf} {rtf} "$@"\n'
    )
    program.chmod(0o755)
    monkeypatch.setenv("TMPDIR", str(small))
    run = start(str(program), tmp_path, "topics", "--all", "seconds=60")
    expect("exit code", run.wait(), 1)
    (reason,) = set(run.reasons())
    expect_in("the bag cannot be written: ", reason)
    expect_in("No space left on device", reason)


def test_a_killed_recorder_is_a_collapse(rtf: str, tmp_path: Path) -> None:
    run = start(rtf, tmp_path, "suite", "--all", "seconds=30")

    def kill_recorder() -> None:
        kill(running("program.py"))

    run.collapses(kill_recorder, "bad")
    expect("exit code", run.wait(), 1)
    expect("reasons", run.reasons(), ["the recorder was killed by SIGKILL"])
    expect("verdicts", run.attempts()[:2], ["passed", "collapsed"])


def test_page(rtf: str, tmp_path: Path) -> None:
    run_fixture_page(rtf, "ros2bag", tmp_path / "page")


def start(rtf: str, directory: Path, suite: str, options: str, *settings: str) -> Run:
    """Starts a run."""
    directory.mkdir(exist_ok=True)
    set_all = [f"--set={each}" for each in (f"options={options}", *settings)]
    return Run(rtf, str(SUITES / f"{suite}.xml"), directory / "results", *set_all)


def bags(run: Run) -> list[Path]:
    """The directories of all attached bags; each has two files."""
    results = run.journal.parent
    files = [results / event["attachment"]["path"] for event in run.events("attached")]
    found = sorted({file.parent for file in files})
    for bag in found:
        names = sorted(file.name for file in files if file.parent == bag)
        name = bag.name.removeprefix("1-")
        expect("attached", names, sorted([f"{name}_0.mcap", "metadata.yaml"]))
        expect("files in the results", sorted(file.name for file in bag.iterdir()), names)
    return found


def content(bag: Path) -> dict[str, Any]:
    """The topics of a bag."""
    found: dict[str, Any] = json.loads(output_of(venv("ros2") / "python", READER, bag))
    return found


def notes(run: Run) -> str:
    """All reports in the results."""
    return "\n".join(str(event["message"]["text"]) for event in run.events("message"))
