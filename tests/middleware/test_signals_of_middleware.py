"""Records signals of real middleware, of recordings, and of tests."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from checkout import ROOT, call
from run import Run, expect, expect_in
from sources import each_source

Points = list[tuple[float, float]]

LOW = "always(100rad > wrist)", "always(0.001rad > wrist)"
UNKNOWN = {
    "ros": ("/joint_states.position[elbow]", "/joint_states.position[ankle]"),
    "ros2": ("/joints.data[0]", "/joints.data[7]"),
    "yarp": ("/arm/state:o[1][0]", "/arm/state:o[1][7]"),
}
PROBLEMS = {
    "ros": "there is no `ankle` among elbow, wrist",
    "ros2": "`/joints.data[7]`: array index out of range",
    "yarp": "has only 2 values",
}


@pytest.fixture(autouse=True)
def suites(home: Path, tmp_path: Path) -> Path:
    """A copy of the suites, which tests change."""
    del home
    return Path(shutil.copytree(ROOT / "tests/fixtures/signals", tmp_path / "suites"))


@each_source
def test_samples_have_the_times_of_their_headers(
    rtf: str, suites: Path, tmp_path: Path, source: str
) -> None:
    """Each topic has its rate."""
    run = Run(rtf, str(suites / f"{source}.xml"), tmp_path / "results")
    expect("exit code", run.wait(), 0)
    points = samples(run)
    expect("signals", set(points), {"elbow", "wrist", "battery"})
    expect("joint states", len(points["elbow"]) > 20, True)
    expect("fewer voltages", 2 < len(points["battery"]) < len(points["elbow"]) / 2, True)
    expect("voltage", {value for _, value in points["battery"]}, {12.3})
    (first, low), (last, high) = points["wrist"][0], points["wrist"][-1]
    # The publisher counts, and a busy machine delays it.
    expect("0.1 rad/s", 0 < (high - low) / (last - first) < 0.2, True)
    expect("times of the test", 0 <= first < last < 60, True)


@each_source
def test_a_monitor_ends_the_test(rtf: str, suites: Path, tmp_path: Path, source: str) -> None:
    suite = suites / f"{source}.xml"
    change(suite, *LOW)
    stopped(Run(rtf, str(suite), tmp_path / "results"))


@each_source
def test_a_field_that_messages_do_not_have_is_an_error(
    rtf: str, suites: Path, tmp_path: Path, source: str
) -> None:
    suite = suites / f"{source}.xml"
    change(suite, *LOW)
    change(suite, *UNKNOWN[source])
    run = Run(rtf, str(suite), tmp_path / "results")
    expect("exit code", run.wait(), 1)
    expect_in(PROBLEMS[source], output(run))


@pytest.mark.venv("mcap")
def test_monitors_judge_a_test_and_its_recording(rtf: str, suites: Path, tmp_path: Path) -> None:
    run = Run(rtf, str(suites / "own.xml"), tmp_path / "own")
    expect("exit code", run.wait(), 0)
    # The samples of the test are not recorded twice.
    level = samples(run)["level"]
    expect("samples", len(level) == len({time for time, _ in level}), True)
    robustness = measured(run)
    expect("0.9 V above the limit", round(robustness["monitor/full"], 6), 0.9)
    expect("the level rises", 0.2 < robustness["monitor/rises"] < 0.5, True)
    of_recording(rtf, suites, tmp_path / "mcap", attached(run, ".mcap"), "/level")


@pytest.mark.venv("mcap")
def test_a_monitor_of_its_own_samples_ends_a_test(rtf: str, suites: Path, tmp_path: Path) -> None:
    options = ["--set", "limit=0.1"]
    stopped(Run(rtf, str(suites / "own.xml"), tmp_path / "results", *options), "low")


@pytest.mark.venv("mcap")
def test_another_unit_than_that_of_the_suite_is_an_error(
    rtf: str, suites: Path, tmp_path: Path
) -> None:
    change(suites / "own.xml", 'name="level" unit="m"', 'name="level" unit="cm"')
    run = Run(rtf, str(suites / "own.xml"), tmp_path / "results")
    expect("exit code", run.wait(), 1)
    expect_in("the test reports `level` in `m`, but its unit in the suite is `cm`", output(run))


@pytest.mark.middleware("ros1")
def test_monitors_judge_a_bag(
    rtf: str, suites: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """ROS's own library has written it."""
    bag = tmp_path / "arm.bag"
    # That of Debian's ROS 1.
    monkeypatch.setenv("RTF_PYTHON", "/usr/bin/python3")
    call("/usr/bin/python3", suites / "write_bag.py", bag)
    of_recording(rtf, suites, tmp_path / "bag", bag, "/joint_states.position[elbow]")


def of_recording(rtf: str, suites: Path, results: Path, file: Path, topic: str) -> None:
    """Each test has all samples, at their times."""
    results.mkdir()
    suite = str(suites / "recorded.xml")
    change(suites / "recorded.xml", 'topic="/level"', f'topic="{topic}"')
    settings = "--set", f"recording={file}"
    run = Run(rtf, suite, results / "played", *settings)
    expect("exit code", run.wait(), 0)
    for test in ("first", "second"):
        points = samples(run, test)["level"]
        expect(f"samples of {test}", len(points) > 20, True)
        (first, low), (last, high) = points[0], points[-1]
        expect("the times of the recording", first < 0.2 and 0.3 < last < 0.8, True)
        expect("1 per second", 0.5 < (high - low) / (last - first) < 1.5, True)
    run = Run(rtf, suite, results / "low", *settings, "--set", "limit=0.3")
    expect("exit code", run.wait(), 1)
    expect("verdicts", run.verdicts(), {"first": "failed", "second": "failed"})
    expect_in("monitor `low`", run.reasons("test-stopping")[1])
    change(suites / "recorded.xml", f'topic="{topic}"', 'topic="/nothing"')
    run = Run(rtf, suite, results / "unknown", *settings)
    expect("exit code", run.wait(), 1)
    expect_in("there is no topic /nothing in the recording; it has /", output(run))


def change(file: Path, old: str, new: str) -> None:
    """Replaces a text in a file."""
    text = file.read_text()
    expect(f"`{old}` in {file.name}", old in text, True)
    file.write_text(text.replace(old, new))


def stopped(run: Run, monitor: str = "wrist stays low") -> None:
    """A monitor ends the test."""
    expect("exit code", run.wait(), 1)
    expect_in(f"monitor `{monitor}`", run.reason("test-stopping"))


def output(run: Run) -> str:
    """What rtf printed."""
    return run.output.read_text()


def attached(run: Run, ending: str) -> Path:
    """The only attachment with this ending."""
    paths = [event["attachment"]["path"] for event in run.events("attached")]
    (path,) = [path for path in paths if path.endswith(ending)]
    found: Path = run.journal.parent / path
    return found.resolve()


def measured(run: Run) -> dict[str, float]:
    """The last value of each measurement."""
    found = [event["measurement"] for event in run.events("measured")]
    return {each["name"]: each["value"] for each in found}


def samples(run: Run, test: str = "") -> dict[str, Points]:
    """All samples of each signal, of all tests or one."""
    found: dict[str, Points] = {}
    for event in run.events("sampled"):
        if test and run.name(event) != test:
            continue
        batch = event["samples"]
        found.setdefault(batch["name"], []).extend((time, value) for time, value in batch["points"])
    return found
