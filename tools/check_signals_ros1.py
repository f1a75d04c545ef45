#!/usr/bin/env python3
"""Records fields of ROS 1 topics with a real master and publisher.

    check_signals_ros1.py RTF DIRECTORY

DIRECTORY contains the suite `ros.xml`.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from pathlib import Path

from run import Run, expect, expect_in

Points = list[tuple[float, float]]

UNKNOWN = "/joint_states.position[elbow]", "/joint_states.position[ankle]"
LOW = "always(100rad > wrist)", "always(0.001rad > wrist)"


def main() -> int:
    """Runs all; exits at the first difference."""
    rtf, example = str(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory() as name:
        os.environ["ROS_HOME"] = f"{name}/home"
        for variable in ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_IP"):
            os.environ.pop(variable, None)
        copy = Path(name) / "suite"
        shutil.copytree(example, copy)
        recorded(Run(rtf, str(copy / "ros.xml"), Path(name) / "recorded"))
        change(copy / "ros.xml", *LOW)
        stopped(Run(rtf, str(copy / "ros.xml"), Path(name) / "stopped"))
        change(copy / "ros.xml", *UNKNOWN)
        unknown(Run(rtf, str(copy / "ros.xml"), Path(name) / "unknown"))
    return 0


def change(file: Path, old: str, new: str) -> None:
    """Replaces a text in a file."""
    text = file.read_text()
    expect_in(old, text)
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


def stopped(run: Run) -> None:
    """A monitor ends the test."""
    expect("exit code", run.wait(), 1)
    expect_in("monitor `wrist stays low`", run.reason("test-stopping"))


def unknown(run: Run) -> None:
    """A joint that the messages do not have."""
    expect("exit code", run.wait(), 1)
    output = run.output.read_text()
    expect_in("there is no `ankle` among elbow, wrist", output)


def samples(run: Run) -> dict[str, Points]:
    """All samples of each signal."""
    found: dict[str, Points] = {}
    for event in run.events("sampled"):
        batch = event["samples"]
        found.setdefault(batch["name"], []).extend((time, value) for time, value in batch["points"])
    return found


if __name__ == "__main__":
    sys.exit(main())
