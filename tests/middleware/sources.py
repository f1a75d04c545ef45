"""The middleware whose clocks, topics and ports are tested."""

from __future__ import annotations

import pytest

each_source = pytest.mark.parametrize(
    "source",
    [
        pytest.param("ros", marks=pytest.mark.middleware("ros1")),
        pytest.param("ros2", marks=pytest.mark.middleware("ros2")),
        pytest.param("yarp", marks=pytest.mark.middleware("yarp")),
    ],
)
