"""How ROS 2 nodes find each other in suites that do not care about it.

No packet may leave the machine from a suite without fixtures; a run with shared middleware
proves that packets are counted. Nodes announce themselves often enough that a new one hears
the others soon, also with a profile of the user.
"""

from __future__ import annotations

from pathlib import Path

import network
import pytest
from checkout import ROOT
from run import Run, expect

pytestmark = [pytest.mark.middleware("ros2"), pytest.mark.outside_network]
SUITES = ROOT / "tests/fixtures/discovery"
VARIABLES = (
    "ROS_DOMAIN_ID",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_LOCALHOST_ONLY",
    "FASTDDS_DEFAULT_PROFILES_FILE",
    "FASTRTPS_DEFAULT_PROFILES_FILE",
)


@pytest.fixture(autouse=True)
def _without_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)


@pytest.mark.parametrize(("suite", "tests"), [("unprepared.xml", 2), ("Hear.py", 1)])
def test_no_packet_leaves_without_fixtures(
    rtf: str, tmp_path: Path, suite: str, tests: int
) -> None:
    with network.quiet(suite):
        passes(Run(rtf, str(SUITES / suite), tmp_path / "results"), tests)


def test_packets_of_shared_middleware_leave(rtf: str, tmp_path: Path) -> None:
    before = network.packets()
    passes(Run(rtf, str(SUITES / "shared.xml"), tmp_path / "results"), 1)
    expect("packets that left, at least one", network.packets() - before > 0, True)


@pytest.mark.parametrize("joins_profile", [False, True], ids=["default", "profile of the user"])
def test_a_new_node_hears_the_others_soon(
    rtf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, joins_profile: bool
) -> None:
    options = []
    if joins_profile:
        monkeypatch.setenv("FASTDDS_DEFAULT_PROFILES_FILE", str(SUITES / "profile.xml"))
        options = ["--set", "contains=left-arm"]
    passes(Run(rtf, str(SUITES / "announcements.xml"), tmp_path / "results", *options), 1)


def passes(run: Run, tests: int) -> None:
    """So many tests pass."""
    expect("exit code", run.wait(), 0)
    expect("verdicts", run.attempts(), ["passed"] * tests)
