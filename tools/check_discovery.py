#!/usr/bin/env python3
"""Checks how ROS 2 nodes find each other in suites that do not care about it.

    check_discovery.py RTF DIRECTORY

No packet may leave the machine from a suite without fixtures; a run with shared middleware
proves that packets are counted. Nodes announce themselves often enough that a new one hears
the others soon, also with a profile of the user.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

import network
from run import Run, expect

VARIABLES = (
    "ROS_DOMAIN_ID",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_LOCALHOST_ONLY",
    "FASTDDS_DEFAULT_PROFILES_FILE",
    "FASTRTPS_DEFAULT_PROFILES_FILE",
)


def main() -> int:
    """Runs all; exits at the first difference."""
    network.move_in()
    rtf, suites = (str(Path(argument).resolve()) for argument in sys.argv[1:])
    for name in VARIABLES:
        os.environ.pop(name, None)
    with tempfile.TemporaryDirectory() as directory:
        results = Path(directory)
        with network.quiet("a suite without fixtures"):
            passes(rtf, f"{suites}/unprepared.xml", results / "unprepared", tests=2)
        with network.quiet("a plug-in without a suite"):
            passes(rtf, f"{suites}/Hear.py", results / "plugin", tests=1)
        packets = network.packets()
        passes(rtf, f"{suites}/shared.xml", results / "shared", tests=1)
        expect("packets that left, at least one", network.packets() - packets > 0, True)
        announcements = f"{suites}/announcements.xml"
        passes(rtf, announcements, results / "announcements", tests=1)
        os.environ["FASTDDS_DEFAULT_PROFILES_FILE"] = f"{suites}/profile.xml"
        contains = ("--set", "contains=left-arm")
        passes(rtf, announcements, results / "joined", *contains, tests=1)
    return 0


def passes(rtf: str, suite: str, results: Path, *options: str, tests: int) -> None:
    """A run in which so many tests pass."""
    run = Run(rtf, suite, results, *options)
    expect("exit code", run.wait(), 0)
    expect("verdicts", run.attempts(), ["passed"] * tests)


if __name__ == "__main__":
    sys.exit(main())
