"""The environment of runs with middleware."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The directory for the files of ROS and YARP, without settings of the user."""
    directory = tmp_path / "home"
    for name in ("ROS_HOME", "YARP_CONFIG_HOME"):
        monkeypatch.setenv(name, str(directory))
    for name in ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_IP", "YARP_NAMESPACE"):
        monkeypatch.delenv(name, raising=False)
    return directory
