#!/usr/bin/env python3
"""Records signals of real middleware, of recordings, and of tests.

    check_signals.py RTF DIRECTORY SOURCE

SOURCE is `ros`, `ros2` or `yarp`, whose suite has this name in DIRECTORY, or `own`: what tests
report, and its recording. `own` needs a Python with the library `mcap`, also in the suites; `ros`
also records and reads a bag.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from run import Run, expect, expect_in

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


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, example = str(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve()
    source = sys.argv[3]
    with tempfile.TemporaryDirectory() as name:
        os.environ["ROS_HOME"] = os.environ["YARP_CONFIG_HOME"] = f"{name}/home"
        for variable in ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_IP", "YARP_NAMESPACE"):
            os.environ.pop(variable, None)
        copy = Path(name) / "suite"
        shutil.copytree(example, copy)
        if source == "own":
            of_tests_and_recordings(rtf, copy, Path(name))
        else:
            of_middleware(rtf, copy / f"{source}.xml", Path(name))
        if source == "ros":
            of_bags(rtf, copy, Path(name))
    return 0


def of_middleware(rtf: str, suite: Path, results: Path) -> None:
    """Samples are recorded; a monitor stops the test; an unknown field is an error."""
    source = suite.stem
    recorded(Run(rtf, str(suite), results / "recorded"))
    change(suite, *LOW)
    stopped(Run(rtf, str(suite), results / "stopped"))
    change(suite, *UNKNOWN[source])
    unknown(Run(rtf, str(suite), results / "unknown"), PROBLEMS[source])


def of_tests_and_recordings(rtf: str, suites: Path, results: Path) -> None:
    """Monitors judge what a test reports, and afterwards its recording."""
    own = str(suites / "own.xml")
    run = Run(rtf, own, results / "own")
    expect("exit code", run.wait(), 0)
    # The samples of the test are not recorded twice.
    level = samples(run)["level"]
    expect("samples", len(level) == len({time for time, _ in level}), True)
    robustness = measured(run)
    expect("0.9 V above the limit", round(robustness["monitor/full"], 6), 0.9)
    expect("the level rises", 0.2 < robustness["monitor/rises"] < 0.5, True)
    recording = attached(run, ".mcap")
    stopped(Run(rtf, own, results / "own-low", "--set", "limit=0.1"), "low")
    change(suites / "own.xml", 'name="level" unit="m"', 'name="level" unit="cm"')
    run = Run(rtf, own, results / "own-unit")
    expect("exit code", run.wait(), 1)
    expect_in("the test reports `level` in `m`, but its unit in the suite is `cm`", output(run))
    of_recording(rtf, suites, results / "mcap", recording, "/level")


def of_bags(rtf: str, suites: Path, results: Path) -> None:
    """A bag that ROS's own library has written."""
    bag = results / "arm.bag"
    # That of Debian's ROS 1.
    os.environ["RTF_PYTHON"] = "/usr/bin/python3"
    subprocess.run([os.environ["RTF_PYTHON"], suites / "write_bag.py", bag], check=True)
    of_recording(rtf, suites, results / "bag", bag, "/joint_states.position[elbow]")


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


def recorded(run: Run) -> None:
    """Each topic has its rate, and the times are those of the headers."""
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


def stopped(run: Run, monitor: str = "wrist stays low") -> None:
    """A monitor ends the test."""
    expect("exit code", run.wait(), 1)
    expect_in(f"monitor `{monitor}`", run.reason("test-stopping"))


def unknown(run: Run, problem: str) -> None:
    """A value that the messages do not have."""
    expect("exit code", run.wait(), 1)
    expect_in(problem, output(run))


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


if __name__ == "__main__":
    sys.exit(main())
