"""The environment of runs with middleware."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from checkout import ROOT


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The directory for the files of ROS and YARP, without settings of the user."""
    directory = tmp_path / "home"
    for name in ("ROS_HOME", "YARP_CONFIG_HOME"):
        monkeypatch.setenv(name, str(directory))
    for name in ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_IP", "YARP_NAMESPACE"):
        monkeypatch.delenv(name, raising=False)
    return directory


@pytest.fixture
def data_of_yarp(monkeypatch: pytest.MonkeyPatch) -> None:
    """YARP has more data."""
    data = ROOT / "tests/fixtures/yarp/data"
    monkeypatch.setenv("YARP_DATA_DIRS", f"{os.environ['YARP_DATA_DIRS']}:{data}")
