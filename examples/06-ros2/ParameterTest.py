"""Parameters: the limit of the speed holds, and cannot be set to what the motor cannot bear."""

from __future__ import annotations

import time

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue, SetParametersResult
from rcl_interfaces.srv import SetParameters
from station import StationTest


class ParameterTest(StationTest):
    """Sets `speed_limit`, and measures what the joint makes of it."""

    def run(self) -> None:
        self.arrive(0.0, timeout=20)
        refused = self.limit(5.0)
        self.check(not refused.successful, "a limit of 5 rad/s is refused")
        self.report(f"refused: {refused.reason}")
        self.require(self.limit(0.5).successful, "a limit of 0.5 rad/s is accepted")
        started = time.monotonic()
        self.arrive(0.5, timeout=20)
        self.measure("time for 0.5 rad", time.monotonic() - started, "s", low=0.9)
        self.require(self.limit(1.0).successful, "a limit of 1 rad/s is accepted")
        self.arrive(0.0, timeout=20)

    def limit(self, speed: float) -> SetParametersResult:
        """Set the limit, in rad/s."""
        value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=speed)
        request = SetParameters.Request(parameters=[Parameter(name="speed_limit", value=value)])
        return self.call(SetParameters, "joint/set_parameters", request).results[0]
